/* SPDX-License-Identifier: Apache-2.0 */
/* Two builds with equal ids give the same hashes and outputs: the id is the cksum of every tick in
 * tests/golden. Written by `make golden-update`; tests/determinism/hashes.sh checks it. It stands in images
 * and recordings, and is no part of the state's hash. */
#ifndef FRAY_IMAGE_PHYSICS_ID_H
#define FRAY_IMAGE_PHYSICS_ID_H

#define PHYSICS_ID 0x4131057Du

#endif

/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/fray.h"

int main() { return FRAY_IMAGE_MAJOR == 2u ? 0 : 1; }

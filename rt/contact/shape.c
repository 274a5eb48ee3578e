/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/contact/shape.h"

int32_t shape_depth_at(const rigid_body *s, vec3 d, int32_t skin, vec3 *normal) {
  FRAY_ASSERT(body_is_primitive(s) && skin >= 0);
  return shape_depth(s, d, skin, normal);
}

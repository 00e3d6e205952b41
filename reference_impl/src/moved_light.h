// One light as a point that has been moved sees it, in double: what every model's sensitivity needs.
#pragma once

#include <cmath>

#include "world.h"

namespace equilux {

// max(0, cos)^p
inline double power(double cosine, double exponent) { return cosine > 0 ? std::pow(cosine, exponent) : 0; }

// L, unit, and E = strength × share; toward: from the moved point to the light, not looked at for a directional one. The cone is not
// looked at either: whether the point is inside is held. False: the light lies in the point, and has no direction.
inline bool seen_from_moved(const Light& light, const Vec3d& toward, Vec3d& to_light, double& share) {
  const LightDescription& given = light.given;
  to_light = light.to_light_rounded;
  share = 1;
  if (given.kind == LightKind::directional) return true;
  const double r2 = dot(toward, toward), r = std::sqrt(r2);
  if (r == 0) return false;
  to_light = toward * (1 / r);
  share = 1 / (given.constant + given.linear * r + given.quadratic * r2);
  if (given.kind == LightKind::spot && given.exponent > 0) share *= power(-dot(to_light, light.axis_rounded), given.exponent);
  return true;
}

}  // namespace equilux

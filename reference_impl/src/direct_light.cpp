#include "direct_light.h"

namespace equilux {
namespace {

// Rounding of the angles of a scan line and of their sines, in units of 2^-53, for each of its ends.
constexpr double rounding_per_end = 16;

}  // namespace

bool DirectLight::look_at(int emitter, const Reflecting& at, const Vec3d& axis, double half_angle) {
  const World& world = obstacles_.world;
  view_ = EmitterView{};
  if (emitter < 0) {
    view_of_environment(axis, half_angle, at.point.normal, view_);
    return true;
  }
  const EmitterDescription& given = world.description.emitters[static_cast<std::size_t>(emitter)];
  const Vec3d from = to_double(difference(given.a, world.camera.eye) - at.point.position);
  switch (given.kind) {
    case EmitterKind::sphere: return view_of_sphere(from, given.radius, at.point.normal, view_);
    case EmitterKind::disc: return view_of_disc(from, to_double(direction_of(given.b)), given.radius, at.point.normal, view_);
    case EmitterKind::rectangle: return view_of_rectangle(from, given.b, given.c, view_);
  }
  return false;
}

Integral DirectLight::from(int emitter, const Reflecting& at, Terms weight, double error_target) {
  const bool specular = at.specular && weight.specular > 0, diffuse = weight.diffuse > 0;
  Integral total;
  if (!specular && !diffuse) return total;
  if (emitter >= 0) {
    if (!look_at(emitter, at, {}, 0)) return total;
    const int object = obstacles_.world.first_emitter() + emitter;
    return over_view(at, object, diffuse, specular, weight, error_target);
  }
  // The environment fills the hemisphere: each term is taken about the axis in which it is simple.
  if (diffuse) {
    look_at(emitter, at, at.point.normal, pi);
    total = over_view(at, -1, true, false, weight, error_target);
  }
  if (specular) {
    look_at(emitter, at, at.lobe.mirrored, at.lobe.reach);
    const Integral lobe = over_view(at, -1, false, true, weight, error_target);
    total.value = total.value + lobe.value;
    total.error = total.error + lobe.error;
    total.reached = total.reached && lobe.reached;
  }
  return total;
}

Terms DirectLight::scan(double turn, const Reflecting& at, bool blocked, bool diffuse, bool specular) {
  double slope;
  const HalfPlane plane = view_.pencil.at(view_.azimuth_of(turn, slope));
  const Stretch above = in_front_of(at.point.normal, plane, view_.stretch(plane));
  Terms sum;
  if (above.empty()) return sum;
  const auto add = [&](Stretch piece) {
    if (diffuse) sum.diffuse += cosine_scan(at.point.normal, plane, piece);
    if (specular) sum.specular += at.lobe.scan(plane, piece);
  };
  if (blocked) {
    blockers_.gaps(plane, above, gaps_);
    gaps_.rest_of(above, add);
  } else {
    add(above);
  }
  return sum * slope;
}

void DirectLight::arrange_breakpoints(const Reflecting& at, bool blocked, bool specular) {
  breakpoints_.clear();
  const Pencil& pencil = view_.pencil;
  view_.crossings_with(at.point.normal, breakpoints_);
  if (specular) {
    view_.crossings_with(at.lobe.mirrored, breakpoints_);
    const Vec3d corner = cross(at.point.normal, at.lobe.mirrored);  // where the horizon meets the end of the lobe
    if (length(corner) > 1e-9) {
      breakpoints_.push_back({pencil.azimuth(corner), false});
      breakpoints_.push_back({pencil.azimuth(-corner), false});
    }
    // the peak
    const double off_axis = length(cross(at.lobe.mirrored, pencil.axis));
    if (off_axis > 2 * at.lobe.width) {
      const double peak = pencil.azimuth(at.lobe.mirrored), width = at.lobe.width / off_axis;
      for (const double step : {-9.0, -3.0, 0.0, 3.0, 9.0}) {
        if (std::fabs(step) * width < 0.9 * pi) breakpoints_.push_back({peak + step * width, false});
      }
    }
  }
  if (blocked) {
    circles_ = {at.point.normal};
    constexpr double soft = 20;  // a lobe of a larger exponent has ended long before its end
    if (specular && at.lobe.exponent < soft) circles_.push_back(at.lobe.mirrored);
    blockers_.breakpoints(circles_, breakpoints_);
  }

  ends_.clear();
  ends_.push_back({view_.first, false});
  ends_.push_back({view_.last, false});
  if (view_.round_about()) {
    for (const double quarter : {-0.5 * pi, 0.0, 0.5 * pi}) ends_.push_back({quarter, false});
  }
  for (Breakpoint point : breakpoints_) {
    if (view_.round_about()) {
      if (point.at > pi) point.at -= 2 * pi;
      if (point.at < -pi) point.at += 2 * pi;
    }
    point.at = view_.turn_of(point.at);
    if (point.at > view_.first && point.at < view_.last) ends_.push_back(point);
  }
  std::sort(ends_.begin(), ends_.end(), [](const Breakpoint& a, const Breakpoint& b) { return a.at < b.at; });
  std::size_t kept = 0;
  const double same = 1e-12 * (view_.last - view_.first);
  for (std::size_t i = 1; i < ends_.size(); ++i) {
    if (ends_[i].at - ends_[kept].at <= same) {
      ends_[kept].steep |= ends_[i].steep;
    } else {
      ends_[++kept] = ends_[i];
    }
  }
  ends_.resize(kept + 1);
}

Integral DirectLight::over_view(const Reflecting& at, int object, bool diffuse, bool specular, Terms weight, double error_target) {
  const double range = view_.last - view_.first;
  // An angle's rounding moves a stretch's end by so much, across the whole range of azimuths.
  const double sine = view_.kind == EmitterView::Kind::rectangle ? 1 : std::sin(std::min(0.5 * pi, view_.half_angle));
  const Terms rounding = Terms{1, 1} * (2 * rounding_per_end * 0x1p-53 * range * sine);
  const auto open = [&](double turn) { return scan(turn, at, false, diffuse, specular); };
  const auto seen = [&](double turn) { return scan(turn, at, true, diffuse, specular); };

  if (object >= 0 && below_horizon(at)) return {};
  blockers_.gather(obstacles_, at.point, view_, object);
  const bool blocked = !blockers_.empty();
  quadrature_.expect(1);
  arrange_breakpoints(at, false, specular);
  // What would come unblocked is what the target is relative to.
  Integral whole = quadrature_.integrate_relative(open, ends_, weight, blocked ? 1e-2 : error_target);
  if (blocked) {
    const double target = error_target * weighed(whole.value, weight) + weighed(rounding, weight);
    arrange_breakpoints(at, true, specular);
    quadrature_.expect(blockers_.burden());
    whole = quadrature_.integrate(seen, ends_, weight, target);
  }
  if (diffuse) whole.error.diffuse += rounding.diffuse;
  // The lobe's own quadrature (scan_integrals.h): the graded panels of small exponents leave 1e-12, the others less.
  if (specular) whole.error.specular += rounding.specular + 2e-12 * std::fabs(whole.value.specular);
  return whole;
}

}  // namespace equilux

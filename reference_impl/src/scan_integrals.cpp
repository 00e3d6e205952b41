#include "scan_integrals.h"

#include <cmath>

namespace equilux {
namespace {

struct GaussRule {
  static constexpr int nodes = 10;
  std::array<double, nodes> x, weight;

  GaussRule() {
    for (int i = 0; i < nodes; ++i) {
      double t = -std::cos(pi * (i + 0.75) / (nodes + 0.5)), slope = 1;
      for (int step = 0; step < 100; ++step) {
        double previous = 1, here = t;
        for (int k = 2; k <= nodes; ++k) {
          const double next = ((2 * k - 1) * t * here - (k - 1) * previous) / k;
          previous = here;
          here = next;
        }
        slope = nodes * (previous - t * here) / (1 - t * t);
        const double next = t - here / slope;
        const bool settled = std::fabs(next - t) < 1e-16;
        t = next;
        if (settled) break;
      }
      x[static_cast<std::size_t>(i)] = t;
      weight[static_cast<std::size_t>(i)] = 2 / ((1 - t * t) * slope * slope);
    }
  }
};

const GaussRule gauss;

template <class F> double over(double low, double high, const F& f) {
  const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
  double sum = 0;
  for (std::size_t i = 0; i < GaussRule::nodes; ++i) sum += gauss.weight[i] * f(middle + half * gauss.x[i]);
  return sum * half;
}

// f over [low, high] within [0, π/2], where f is cos^p times something smooth.
template <class F> double outward(double low, double high, double step, double exponent, const F& f) {
  constexpr double graded_from = 1.2;
  double sum = 0, from = low;
  const bool graded = exponent < 60 && high > graded_from;
  const double plain_end = graded ? std::max(low, graded_from) : high;
  while (from < plain_end) {
    const double to = plain_end - from < 1.2 * step ? plain_end : from + step;
    sum += over(from, to, f);
    from = to;
  }
  if (graded) {  // what is left is below rest^(p+1) / (p+1)
    double rest = 0.5 * pi - from;
    while (from < high) {
      rest *= 0.25;
      const double to = 0.5 * pi - rest;
      if (to >= high || std::pow(rest, exponent + 1) < 1e-17 || rest < 1e-15) {
        sum += over(from, high, f);
        break;
      }
      sum += over(from, to, f);
      from = to;
    }
  }
  return sum;
}

}  // namespace

double Lobe::scan(const HalfPlane& plane, Stretch at) const {
  const double ra = dot(mirrored, plane.a), rb = dot(mirrored, plane.b), off = dot(mirrored, plane.normal);
  const double shrunk = std::min(1.0, off * off);
  const double peak = exponent == 0 ? 1 : std::exp(0.5 * exponent * std::log1p(-shrunk));  // ρ^p
  if (!(peak > 1e-22)) return 0;
  double centre = std::atan2(rb, ra);
  if (centre < -0.5 * pi) centre += 2 * pi;
  const double low = std::max(at.low - centre, -reach), high = std::min(at.high - centre, reach);
  if (!(low < high)) return 0;
  const double na = dot(normal, plane.a), nb = dot(normal, plane.b), sine0 = std::sin(centre), cosine0 = std::cos(centre);
  const double step = std::min(2 * width, 0.8);
  const auto integrand = [&](double u, double sign) {
    const double s = std::sin(u), c = std::cos(u);
    const double sine = sine0 * c + sign * cosine0 * s;
    double value = power(s, c) * sine;
    if (with_cosine) value *= na * (cosine0 * c - sign * sine0 * s) + nb * sine;
    return value;
  };
  double sum = 0;
  if (high > 0) sum += outward(std::max(low, 0.0), high, step, exponent, [&](double u) { return integrand(u, 1); });
  if (low < 0) sum += outward(std::max(-high, 0.0), -low, step, exponent, [&](double u) { return integrand(u, -1); });
  return peak * sum;
}

}  // namespace equilux

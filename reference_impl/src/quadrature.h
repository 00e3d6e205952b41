// Deterministic adaptive quadrature of a piecewise smooth function of one variable, with an estimate of its error that is meant to cover.
//
// Every panel is one Gauss–Lobatto rule of 11 nodes. Its ends are nodes, so nothing that happens between the outermost node and the end
// escapes unseen. Its error is read from the decay of the integrand's discrete Legendre coefficients, in pairs, so that no chance zero of one
// of them can hide the rest (the null rules of Berntsen and Espelid, "Error estimation in automatic quadrature routines", ACM TOMS 1991):
//     where they decay fast, the function is analytic in the panel, and the next ones are extrapolated;
//     where they do not, there is a kink, a jump or a peak, and the largest of them is the estimate.
// The panel with the largest error is halved until the target is met or the work limit is reached; either way the error is what it is.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace equilux {

// What is integrated at once: two terms that share the geometry of a scan line.
struct Terms {
  double diffuse = 0, specular = 0;
};

inline Terms operator+(Terms a, Terms b) { return {a.diffuse + b.diffuse, a.specular + b.specular}; }
inline Terms operator-(Terms a, Terms b) { return {a.diffuse - b.diffuse, a.specular - b.specular}; }
inline Terms operator*(Terms a, double s) { return {a.diffuse * s, a.specular * s}; }
inline double weighed(Terms a, Terms weight) { return a.diffuse * weight.diffuse + a.specular * weight.specular; }
inline Terms magnitudes(Terms a) { return {std::fabs(a.diffuse), std::fabs(a.specular)}; }

// Where the integrand is not smooth. steep: it starts or ends there like a square root.
struct Breakpoint {
  double at = 0;
  bool steep = false;
};

struct Integral {
  Terms value, error;
  bool reached = true;  // the target
};

// Gauss–Lobatto, 11 nodes on [-1, 1], exact for polynomials of degree 19.
class LobattoRule {
 public:
  static constexpr int nodes = 11, coefficients = 6;  // of the discrete Legendre series, from the last down

  static const LobattoRule& instance() {
    static const LobattoRule rule;
    return rule;
  }

  std::array<double, nodes> x, weight;
  std::array<std::array<double, nodes>, coefficients> series;  // row k: coefficient of the orthonormal polynomial of degree 9 − k

 private:
  LobattoRule() {
    constexpr int n = nodes - 1;
    for (int i = 0; i < nodes; ++i) {
      double t = -std::cos(std::numbers::pi * i / n);
      for (int step = 0; step < 100; ++step) {  // Newton on (1 − t²) P_n'(t): x ← x − (x P_n − P_{n−1}) / ((n + 1) P_n)
        const double p = legendre(n, t), q = legendre(n - 1, t), next = t - (t * p - q) / ((n + 1) * p);
        const bool settled = next == t;
        t = next;
        if (settled) break;
      }
      if (2 * i == n) t = 0;
      x[static_cast<std::size_t>(i)] = t;
      const double p = legendre(n, t);
      weight[static_cast<std::size_t>(i)] = 2 / (n * (n + 1) * p * p);
    }
    for (int k = 0; k < coefficients; ++k) {
      const int degree = nodes - 2 - k;
      for (std::size_t i = 0; i < nodes; ++i) {
        series[static_cast<std::size_t>(k)][i] = weight[i] * legendre(degree, x[i]) * std::sqrt((2 * degree + 1) / 2.0);
      }
    }
  }
  static double legendre(int degree, double t) {
    double previous = 1, here = t;
    if (degree == 0) return previous;
    for (int k = 2; k <= degree; ++k) {
      const double next = ((2 * k - 1) * t * here - (k - 1) * previous) / k;
      previous = here;
      here = next;
    }
    return here;
  }
};

// The error of one rule on [-1, 1], from the pairs of coefficients 9 and 8, 7 and 6, 5 and 4. Calibrated on smooth functions, poles, peaks,
// kinks, roots and jumps at random places and of random heights (tests/unit/tracer/test_emitters_quadrature.py).
inline double rule_error(const std::array<double, LobattoRule::nodes>& values) {
  const LobattoRule& rule = LobattoRule::instance();
  double coefficient[LobattoRule::coefficients], size = 0;
  for (int k = 0; k < LobattoRule::coefficients; ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < LobattoRule::nodes; ++i) sum += rule.series[static_cast<std::size_t>(k)][i] * values[i];
    coefficient[k] = sum;
  }
  for (std::size_t i = 0; i < LobattoRule::nodes; ++i) size += rule.weight[i] * std::fabs(values[i]);
  if (size == 0) return 0;
  const double floor = 0x1p-51 * size;
  const double last = std::hypot(coefficient[0], coefficient[1]) + floor, before = std::hypot(coefficient[2], coefficient[3]) + floor,
               first = std::hypot(coefficient[4], coefficient[5]) + floor;
  const double ratio = std::max(last / before, before / first);
  if (ratio > 0.15) return 2 * std::max({last, before / 2, first / 4}) + floor;
  return 3 * last * std::min(1.0, 20 * ratio) + floor;
}

class AdaptiveQuadrature {
 public:
  static constexpr int largest_work = 1200;  // panels that are evaluated, 11 scan lines each

  // The work limit of the integrals that follow, where f is `burden` times as much work as usual.
  void expect(double burden) { work_ = std::max(48, static_cast<int>(largest_work / burden)); }


  // ∫ f over [ends.front(), ends.back()], ends sorted; f(x) → Terms. Until the error, weighed, is at most `target`.
  template <class F> Integral integrate(const F& f, const std::vector<Breakpoint>& ends, Terms weight, double target) {
    begin(f, ends);
    return refine(f, weight, target);
  }

  // The same, until the error is at most a share of the integral itself.
  template <class F> Integral integrate_relative(const F& f, const std::vector<Breakpoint>& ends, Terms weight, double share) {
    begin(f, ends);
    Terms sum;
    for (const Panel& panel : panels_) sum = sum + panel.value;
    Integral total = refine(f, weight, share * weighed(sum, weight));
    const double target = share * weighed(total.value, weight);  // the first sum may have been too large
    return total.reached && weighed(total.error, weight) > target ? refine(f, weight, target) : total;
  }

 private:
  template <class F> void begin(const F& f, const std::vector<Breakpoint>& ends) {
    panels_.clear();
    finished_.clear();
    evaluated_ = 0;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      if (!(ends[i + 1].at > ends[i].at)) continue;
      Panel panel;
      panel.base = {ends[i], ends[i + 1]};
      evaluate(f, panel);
      panels_.push_back(panel);
    }
  }

  template <class F> Integral refine(const F& f, Terms weight, double target) {
    Integral total;
    double error = 0;
    for (Panel& panel : panels_) {
      panel.weighed_error = weighed(panel.error, weight);
      error += panel.weighed_error;
    }
    double settled = 0;  // error of panels that are as narrow as their ends are known: it stays
    for (const Panel& panel : finished_) settled += weighed(panel.error, weight);
    std::make_heap(panels_.begin(), panels_.end());
    while (error > std::max(target - settled, 0.1 * settled) && !panels_.empty() && evaluated_ < work_) {
      std::pop_heap(panels_.begin(), panels_.end());
      const Panel parent = panels_.back();
      panels_.pop_back();
      if (parent.high - parent.low < 0x1p-40) {
        finished_.push_back(parent);
        error -= parent.weighed_error;
        settled += parent.weighed_error;
        continue;
      }
      Panel half[2] = {parent, parent};
      half[0].high = half[1].low = 0.5 * (parent.low + parent.high);
      for (Panel& panel : half) evaluate(f, panel);
      // A parent that was farther off than it said: its halves are not believed either.
      const Terms surprise = magnitudes(parent.value - (half[0].value + half[1].value)) - parent.error;
      error -= parent.weighed_error;
      for (Panel& panel : half) {
        panel.error.diffuse = std::max(panel.error.diffuse, 0.25 * surprise.diffuse);
        panel.error.specular = std::max(panel.error.specular, 0.25 * surprise.specular);
        panel.weighed_error = weighed(panel.error, weight);
        error += panel.weighed_error;
        panels_.push_back(panel);
        std::push_heap(panels_.begin(), panels_.end());
      }
    }
    for (const Panel& panel : panels_) total.value = total.value + panel.value, total.error = total.error + panel.error;
    for (const Panel& panel : finished_) total.value = total.value + panel.value, total.error = total.error + panel.error;
    total.reached = !(error + settled > target);
    return total;
  }

  // A stretch of [-1, 1], mapped onto the stretch between two breakpoints so that square roots at its ends become smooth.
  struct Panel {
    std::array<Breakpoint, 2> base;
    double low = -1, high = 1;
    Terms value, error;
    double weighed_error = 0;

    bool operator<(const Panel& other) const { return weighed_error < other.weighed_error; }
  };

  struct Mapped {
    double x, slope;
  };
  static Mapped map(const std::array<Breakpoint, 2>& base, double t) {
    const double a = base[0].at, b = base[1].at, length = b - a;
    if (base[0].steep && base[1].steep) return {a + length * ((1 + t) * (1 + t) * (2 - t) / 4), length * (3 - 3 * t * t) / 4};
    if (base[0].steep) return {a + length * ((1 + t) * (1 + t) / 4), length * (1 + t) / 2};
    if (base[1].steep) return {b - length * ((1 - t) * (1 - t) / 4), length * (1 - t) / 2};
    return {a + length * (1 + t) / 2, length / 2};
  }

  template <class F> void evaluate(const F& f, Panel& panel) {
    ++evaluated_;
    const LobattoRule& rule = LobattoRule::instance();
    // The function may jump at the very ends of a panel: it is asked just inside them.
    constexpr double inside = 1 - 0x1p-36;
    const double middle = 0.5 * (panel.low + panel.high), half = 0.5 * (panel.high - panel.low);
    std::array<double, LobattoRule::nodes> diffuse, specular;
    Terms sum;
    for (std::size_t i = 0; i < LobattoRule::nodes; ++i) {
      const Mapped at = map(panel.base, middle + half * inside * rule.x[i]);
      const Terms value = f(at.x) * at.slope;
      diffuse[i] = value.diffuse;
      specular[i] = value.specular;
      sum = sum + value * rule.weight[i];
    }
    panel.value = sum * half;
    panel.error = Terms{rule_error(diffuse), rule_error(specular)} * half;
  }

  std::vector<Panel> panels_, finished_;
  int evaluated_ = 0, work_ = largest_work;
};

}  // namespace equilux

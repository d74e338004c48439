// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What retention curves, conductivity laws and drag laws must offer, the numbers they share, and
/// the adapters through which kernels call them. Library policies are `template <class T>` for Real
/// and Lanes; a user's policy may know Real only and is then called lane by lane.

#include <algorithm>
#include <concepts>
#include <limits>

#include <vadose/core/lanes_math.hpp>
#include <vadose/core/real.hpp>

namespace vadose {

/// Numbers that several hydraulic policies of one material need and Material owns.
struct SharedParameters {
  /// Reference unit weight 9.81 rho_l of the liquid [N/m3], > 0; never the scene's gravity.
  Real liquid_unit_weight = unset;
  /// Porosity at which conductivity and void-ratio independent curves were measured [-], (0, 1).
  Real reference_porosity = unset;
  /// Exponent lambda of [Zhan] Eq. (12), shared by retention and Mualem's conductivity [-], (0, 1).
  Real lambda = unset;
};

/// The policy fills members that are still unset from the shared numbers of its material.
template <class P>
concept AdoptsShared = requires(P& policy, const SharedParameters& shared) {
  policy.adopt(shared);
};

/// Hands the shared numbers to a policy that wants them; others are left alone.
template <class P>
void adopt_shared(P& policy, const SharedParameters& shared) {
  if constexpr (AdoptsShared<P>) policy.adopt(shared);
}

namespace detail {

/// Gives `member` the value unless the user has set it.
inline void fill(Real& member, Real value) noexcept {
  if (!is_finite(member)) member = value;
}

}  // namespace detail

// ---------------------------------------------------------------------------------------------
// Requirements, one small concept each, so that a message can name the one that is missing.

/// `void validate() const` throws SetupError for parameters out of range.
template <class P>
concept HasValidate = requires(const P& policy) {
  policy.validate();
};

/// `Real saturation(Real suction, Real porosity) const`: degree of saturation [-] at suction >= 0
/// [Pa]; 1 at zero suction, never increasing with suction.
template <class R>
concept HasSaturation = requires(const R& curve, Real x) {
  { curve.saturation(x, x) } -> std::convertible_to<Real>;
};

/// `Real saturation_slope(Real suction, Real porosity) const`: dS/ds [1/Pa], <= 0 and finite.
template <class R>
concept HasSaturationSlope = requires(const R& curve, Real x) {
  { curve.saturation_slope(x, x) } -> std::convertible_to<Real>;
};

/// A soil-water retention curve. Optional members: saturation_porosity_slope(s, n) (dS/dn at
/// constant suction), saturation_and_slope(s, n), suction(S, n), residual_saturation,
/// suction_scale(n) (see KirchhoffMean), adopt(shared).
template <class R>
concept RetentionCurve = HasSaturation<R> && HasSaturationSlope<R> && HasValidate<R>;

/// `Real conductivity(Real effective_saturation, Real porosity) const`: hydraulic conductivity
/// [m/s], > 0.
template <class C>
concept HasConductivity = requires(const C& law, Real x) {
  { law.conductivity(x, x) } -> std::convertible_to<Real>;
};

/// A conductivity law. Optional members: saturated(n) and relative(Se) with
/// conductivity = saturated * relative, adopt(shared).
template <class C>
concept ConductivityLaw = HasConductivity<C> && HasValidate<C>;

/// k(Se, n) = saturated(n) relative(Se), relative(1) = 1.
template <class C>
concept FactorisingConductivity = ConductivityLaw<C> && requires(const C& law, Real x) {
  { law.saturated(x) } -> std::convertible_to<Real>;
  { law.relative(x) } -> std::convertible_to<Real>;
};

/// S depends on suction and porosity through x = suction_scale(n) s only [1/Pa].
template <class R>
concept ScalingRetention = RetentionCurve<R> && requires(const R& curve, Real x) {
  { curve.suction_scale(x) } -> std::convertible_to<Real>;
};

/// `Real coefficient(Real porosity, Real saturation, Real conductivity, Real unit_weight) const`:
/// drag force per unit *liquid* volume and relative velocity [kg m^-3 s^-1].
template <class D>
concept HasDragCoefficient = requires(const D& law, Real x) {
  { law.coefficient(x, x, x, x) } -> std::convertible_to<Real>;
};

/// A drag law. Optional member: quadratic(n, S, k, unit_weight, liquid_density) [kg m^-4], the
/// factor of |w| w.
template <class D>
concept DragLaw = HasDragCoefficient<D> && HasValidate<D>;

/// The drag law has a term in the square of the relative velocity.
template <class D>
concept QuadraticDrag = DragLaw<D> && requires(const D& law, Real x) {
  { law.quadratic(x, x, x, x, x) } -> std::convertible_to<Real>;
};

/// The curve declares `static constexpr bool always_saturated = true`.
template <class R>
inline constexpr bool is_always_saturated = false;
/// The same where the curve says it.
template <class R>
requires requires {
  R::always_saturated;
}
inline constexpr bool is_always_saturated<R> = R::always_saturated;

namespace detail {

/// f(a..., lane by lane) for policies that know Real only.
template <class F, class... A>
Lanes lane_by_lane(F&& f, const A&... a) {
  Lanes r(0.0);
  for (int l = 0; l < lane_count; ++l) r.set(l, f(a[l]...));
  return r;
}

// The policy's own member accepts T and returns it.
template <class R, class T>
concept SaturationIn = requires(const R& curve, T x) {
  { curve.saturation(x, x) } -> std::same_as<T>;
};
template <class R, class T>
concept SlopeIn = requires(const R& curve, T x) {
  { curve.saturation_slope(x, x) } -> std::same_as<T>;
};
template <class R, class T>
concept PorositySlopeIn = requires(const R& curve, T x) {
  { curve.saturation_porosity_slope(x, x) } -> std::same_as<T>;
};
template <class R, class T>
concept CombinedSlopeIn = requires(const R& curve, T x) {
  { curve.saturation_and_slope(x, x).slope } -> std::convertible_to<T>;
};
template <class C, class T>
concept ConductivityIn = requires(const C& law, T x) {
  { law.conductivity(x, x) } -> std::same_as<T>;
};
template <class R, class T>
concept ScaleIn = requires(const R& curve, T x) {
  { curve.suction_scale(x) } -> std::same_as<T>;
};
template <class C, class T>
concept RelativeIn = requires(const C& law, T x) {
  { law.relative(x) } -> std::same_as<T>;
};
template <class C, class T>
concept SaturatedIn = requires(const C& law, T x) {
  { law.saturated(x) } -> std::same_as<T>;
};
template <class D, class T>
concept DragIn = requires(const D& law, T x) {
  { law.coefficient(x, x, x, x) } -> std::same_as<T>;
};
template <class D, class T>
concept QuadraticIn = requires(const D& law, T x) {
  { law.quadratic(x, x, x, x, x) } -> std::same_as<T>;
};

}  // namespace detail

/// Soil-water retention curves and the adapters that call them.
namespace swrc {

/// Degree of saturation [-] and dS/ds [1/Pa].
template <class T>
struct SaturationAndSlope {
  T saturation;  ///< S [-]
  T slope;       ///< dS/ds [1/Pa]
};

/// Degree of saturation [-] at suction >= 0 [Pa] and porosity [-].
template <class T, class Curve>
T saturation(const Curve& curve, T suction, T porosity) {
  if constexpr (detail::SaturationIn<Curve, T>) {
    return curve.saturation(suction, porosity);
  } else if constexpr (std::same_as<T, Lanes>) {
    return detail::lane_by_lane(
        [&](Real s, Real n) { return static_cast<Real>(curve.saturation(s, n)); }, suction,
        porosity);
  } else {
    return static_cast<Real>(curve.saturation(suction, porosity));
  }
}

/// dS/ds at constant porosity [1/Pa], <= 0.
template <class T, class Curve>
T slope(const Curve& curve, T suction, T porosity) {
  if constexpr (detail::SlopeIn<Curve, T>) {
    return curve.saturation_slope(suction, porosity);
  } else if constexpr (std::same_as<T, Lanes>) {
    return detail::lane_by_lane(
        [&](Real s, Real n) { return static_cast<Real>(curve.saturation_slope(s, n)); }, suction,
        porosity);
  } else {
    return static_cast<Real>(curve.saturation_slope(suction, porosity));
  }
}

/// S and dS/ds together, by one evaluation where the curve offers it.
template <class T, class Curve>
SaturationAndSlope<T> saturation_and_slope(const Curve& curve, T suction, T porosity) {
  if constexpr (detail::CombinedSlopeIn<Curve, T>) {
    const auto both = curve.saturation_and_slope(suction, porosity);
    return {both.saturation, both.slope};
  } else {
    return {saturation<T>(curve, suction, porosity), slope<T>(curve, suction, porosity)};
  }
}

/// dS/dn at constant suction [-], <= 0 for curves that shift with the void ratio; a central
/// difference (relative error about 1e-8) where the curve does not offer it.
template <class T, class Curve>
T porosity_slope(const Curve& curve, T suction, T porosity) {
  if constexpr (detail::PorositySlopeIn<Curve, T>) {
    return curve.saturation_porosity_slope(suction, porosity);
  } else if constexpr (std::same_as<T, Lanes>) {
    return detail::lane_by_lane([&](Real s, Real n) { return porosity_slope<Real>(curve, s, n); },
                                suction, porosity);
  } else if constexpr (detail::PorositySlopeIn<Curve, Real>) {
    return curve.saturation_porosity_slope(suction, porosity);
  } else {
    const Real h = 1e-5 * std::min(porosity, 1 - porosity);
    return (saturation<Real>(curve, suction, porosity + h) -
            saturation<Real>(curve, suction, porosity - h)) /
           (2 * h);
  }
}

/// What a curve that depends on x = suction_scale(n) s only multiplies the suction by [1/Pa].
template <class T, ScalingRetention Curve>
T suction_scale(const Curve& curve, T porosity) {
  if constexpr (detail::ScaleIn<Curve, T>)
    return curve.suction_scale(porosity);
  else if constexpr (std::same_as<T, Lanes>)
    return detail::lane_by_lane([&](Real n) { return static_cast<Real>(curve.suction_scale(n)); },
                                porosity);
  else
    return static_cast<Real>(curve.suction_scale(porosity));
}

/// Residual degree of saturation [-]; 0 for curves without one.
template <class Curve>
Real residual_saturation(const Curve& curve) {
  if constexpr (requires { static_cast<Real>(curve.residual_saturation); }) {
    return static_cast<Real>(curve.residual_saturation);
  } else {
    return 0;
  }
}

/// Effective degree of saturation (S - S_res) / (1 - S_res) [-], limited to [0, 1].
template <class T, class Curve>
T effective_saturation(const Curve& curve, T saturation_value) {
  const Real residual = residual_saturation(curve);
  const T effective = (saturation_value - T(residual)) * T(1 / (1 - residual));
  return min(max(effective, T(0.0)), T(1.0));
}

/// Smallest suction [Pa] at which the curve gives the degree of saturation `target` [-]; 0 for
/// target >= 1, infinite where the curve never gets that dry below 1e15 Pa. Closed form where the
/// curve has one, else bisection in log(suction) to round-off. For set-up, not for kernels.
template <class Curve>
Real suction(const Curve& curve, Real target, Real porosity) {
  if constexpr (requires { static_cast<Real>(curve.suction(target, porosity)); }) {
    return static_cast<Real>(curve.suction(target, porosity));
  } else {
    if (!(target < 1)) return 0;
    Real low = 1e-9;
    Real high = 1e15;
    if (saturation<Real>(curve, low, porosity) <= target) return low;
    if (saturation<Real>(curve, high, porosity) > target)
      return std::numeric_limits<Real>::infinity();
    for (int i = 0; i < 200 && high > low; ++i) {
      const Real middle = std::sqrt(low) * std::sqrt(high);
      if (!(middle > low && middle < high)) break;
      (saturation<Real>(curve, middle, porosity) <= target ? high : low) = middle;
    }
    return high;
  }
}

/// Volumetric water content at reference density [-] and its derivative to pressure [1/Pa].
template <class T>
struct WaterContent {
  T value;  ///< theta [-]
  T slope;  ///< d(theta)/dp [1/Pa]
};

/// theta = n S(max(0, -p), n) exp(p/K) and d theta/dp = n (S/K + S_p) exp(p/K), S_p = -dS/ds for
/// p < 0 and 0 for p >= 0: positive and increasing in p at any suction.
/// p liquid pressure [Pa], compression +; n porosity [-]; 1/K inverse bulk modulus [1/Pa], >= 0.
template <class T, class Curve>
WaterContent<T> water_content(const Curve& curve, T liquid_pressure, T porosity,
                              T inverse_bulk_modulus) {
  const T compression = exp_of_small(liquid_pressure * inverse_bulk_modulus);
  if constexpr (is_always_saturated<Curve>) {
    const T theta = porosity * compression;
    return {theta, theta * inverse_bulk_modulus};
  } else {
    const auto s = saturation_and_slope<T>(curve, max(-liquid_pressure, T(0.0)), porosity);
    const T storage = select(liquid_pressure < T(0.0), -s.slope, T(0.0));
    const T factor = porosity * compression;
    return {factor * s.saturation, factor * (s.saturation * inverse_bulk_modulus + storage)};
  }
}

}  // namespace swrc

/// Hydraulic conductivity laws and the adapter that calls them.
namespace conductivity {

/// Hydraulic conductivity [m/s] at effective saturation [-] and porosity [-].
template <class T, class Law>
T value(const Law& law, T effective_saturation, T porosity) {
  if constexpr (detail::ConductivityIn<Law, T>) {
    return law.conductivity(effective_saturation, porosity);
  } else if constexpr (std::same_as<T, Lanes>) {
    return detail::lane_by_lane(
        [&](Real se, Real n) { return static_cast<Real>(law.conductivity(se, n)); },
        effective_saturation, porosity);
  } else {
    return static_cast<Real>(law.conductivity(effective_saturation, porosity));
  }
}

/// Hydraulic conductivity [m/s] of saturated soil at porosity [-].
template <class T, class Law>
T saturated(const Law& law, T porosity) {
  if constexpr (FactorisingConductivity<Law> && detail::SaturatedIn<Law, T>)
    return law.saturated(porosity);
  else
    return value<T>(law, T(1.0), porosity);
}

/// Relative conductivity k_r [-] of a law that factorises, at effective saturation [-].
template <class T, FactorisingConductivity Law>
T relative(const Law& law, T effective_saturation) {
  if constexpr (detail::RelativeIn<Law, T>)
    return law.relative(effective_saturation);
  else if constexpr (std::same_as<T, Lanes>)
    return detail::lane_by_lane([&](Real se) { return static_cast<Real>(law.relative(se)); },
                                effective_saturation);
  else
    return static_cast<Real>(law.relative(effective_saturation));
}

}  // namespace conductivity

/// Interphase drag laws and the adapters that call them.
namespace drag {

/// Drag per unit liquid volume and relative velocity [kg m^-3 s^-1].
template <class T, class Law>
T coefficient(const Law& law, T porosity, T saturation, T conductivity, T unit_weight) {
  if constexpr (detail::DragIn<Law, T>) {
    return law.coefficient(porosity, saturation, conductivity, unit_weight);
  } else if constexpr (std::same_as<T, Lanes>) {
    return detail::lane_by_lane(
        [&](Real n, Real s, Real k, Real w) {
          return static_cast<Real>(law.coefficient(n, s, k, w));
        },
        porosity, saturation, conductivity, unit_weight);
  } else {
    return static_cast<Real>(law.coefficient(porosity, saturation, conductivity, unit_weight));
  }
}

/// Factor of |w| w in the drag per unit liquid volume [kg m^-4]; 0 for linear laws.
template <class T, class Law>
T quadratic(const Law& law, T porosity, T saturation, T conductivity, T unit_weight,
            T liquid_density) {
  if constexpr (!QuadraticDrag<Law>) {
    return T(0.0);
  } else if constexpr (detail::QuadraticIn<Law, T>) {
    return law.quadratic(porosity, saturation, conductivity, unit_weight, liquid_density);
  } else if constexpr (std::same_as<T, Lanes>) {
    return detail::lane_by_lane(
        [&](Real n, Real s, Real k, Real w, Real r) {
          return static_cast<Real>(law.quadratic(n, s, k, w, r));
        },
        porosity, saturation, conductivity, unit_weight, liquid_density);
  } else {
    return static_cast<Real>(
        law.quadratic(porosity, saturation, conductivity, unit_weight, liquid_density));
  }
}

}  // namespace drag
}  // namespace vadose

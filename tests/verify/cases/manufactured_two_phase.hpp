// SPDX-License-Identifier: MIT
#pragma once

#include <limits>

#include "../case.hpp"
#include "../driven.hpp"

namespace verify {

/// A manufactured solution of both momentum balances and the mass balance of the liquid: small
/// strain, no gravity, a closed box of 1 m. With phi_i = sin(pi x_i) prod_{j != i} cos(pi x_j),
///   u^s_i = A s_i phi_i sin wt,   u^l_i = A l_i phi_i (sin wt + (1 - cos wt)/2),
/// and the pressure follows from the mass balance, without a source:
///   n (S/K + S_p) (p - p0) = - n S div u^l - (S + n S_n) (1-n) div u^s.
/// What the momentum balances lack is a force per mass on the points of either phase. Displacements
/// over A, pressures over their largest value.
template <class K = vadose::PlaneStrain>
struct ManufacturedTwoPhase {
  static constexpr const char* name = "manufactured two-phase";
  static constexpr int dim = K::dim;
  static constexpr Real pi = std::numbers::pi;
  static constexpr Real poisson_ratio = 0.3, porosity = 0.4;
  static constexpr Real solid_density = 2650, liquid_density = 1000;

  using Physics = vadose::UnsaturatedModel<K>;

  Real start_saturation = 1;  ///< [-]
  /// Soft enough that water and skeleton share the load.
  Real young_modulus = start_saturation < 1 ? 1e6 : 10e6;  ///< [Pa]
  Real bulk_modulus = start_saturation < 1 ? 2.2e9 : 2.2e7;
  Real conductivity = 1e-2;                 ///< k_sat [m/s]
  Real frequency = 314;                     ///< w [1/s]
  Real amplitude = 1e-6;                    ///< A [m]
  std::vector<Real> times = {0.005, 0.01};  ///< [s]
  std::vector<Resolution> resolutions = {{8, 0.4}, {16, 0.2}, {32, 0.1}};

  Real seconds(Real time) const { return time; }

  /// The parts that do not depend on time and place.
  struct Coefficients {
    Real pressure = 1e3, saturation = 1;          ///< p0 [Pa], S [-]
    Real pressure_slope = 0, porosity_slope = 0;  ///< S_p [1/Pa], S_n [-]
    Real drag = 0;                                ///< n S gamma_l / k [kg/(m3 s)]
    Real storage = 0;                             ///< n (S/K + S_p) [1/Pa]
    Real lame = 0, shear = 0;
    Vec<dim> solid, liquid;  ///< s_i, l_i [-]
  };

  template <class Model>
  vadose::Material<Model> material() const {
    return {.solid_density = solid_density,
            .porosity = porosity,
            .lambda = 0.63,
            .skeleton = {.young_modulus = young_modulus, .poisson_ratio = poisson_ratio},
            .retention = {.a = 0.02},
            .conductivity = {.saturated_conductivity = conductivity}};
  }

  Coefficients coefficients() const {
    const auto m = material<Physics>().resolved(liquid_density * vadose::reference_gravity);
    Coefficients c;
    if (start_saturation < 1) {
      const Real suction = vadose::swrc::suction(m.retention, start_saturation, porosity);
      c.pressure = -suction;
      c.saturation = start_saturation;
      c.pressure_slope = -vadose::swrc::slope<Real>(m.retention, suction, porosity);
      c.porosity_slope = vadose::swrc::porosity_slope<Real>(m.retention, suction, porosity);
    }
    const Real k = vadose::conductivity::value<Real>(m.conductivity, c.saturation, porosity);
    c.drag = porosity * c.saturation * m.unit_weight / k;
    c.storage = porosity * (c.saturation / bulk_modulus + c.pressure_slope);
    c.shear = young_modulus / (2 * (1 + poisson_ratio));
    c.lame = oedometric_modulus(young_modulus, poisson_ratio) - 2 * c.shear;
    const Real solid[] = {1, -0.4}, liquid[] = {-0.5, 0.8};
    for (int d = 0; d < dim; ++d) {
      c.solid[d] = solid[d];
      c.liquid[d] = liquid[d];
    }
    return c;
  }

  /// Amplitudes in time of u^s and u^l, their first and second derivatives.
  struct Amplitudes {
    Real solid[3], liquid[3];
  };
  Amplitudes amplitudes(Real t) const {
    const Real w = frequency, s = amplitude * std::sin(w * t), c = amplitude * std::cos(w * t);
    return {{s, w * c, -w * w * s},
            {s + 0.5 * (amplitude - c), w * c + 0.5 * w * s, -w * w * s + 0.5 * w * w * c}};
  }
  /// Shape of displacement along an axis, and of all divergences over pi.
  static Vec<dim> wave(const Vec<dim>& x) {
    Vec<dim> phi;
    for (int i = 0; i < dim; ++i) {
      phi[i] = std::sin(pi * x[i]);
      for (int j = 0; j < dim; ++j)
        if (j != i) phi[i] *= std::cos(pi * x[j]);
    }
    return phi;
  }
  static Real wave_divergence(const Vec<dim>& x) {
    Real product = 1;
    for (int i = 0; i < dim; ++i) product *= std::cos(pi * x[i]);
    return product;
  }
  /// (p - p0) / wave_divergence [Pa].
  Real pressure_amplitude(const Coefficients& c, const Amplitudes& a) const {
    const Real solid =
        (c.saturation + porosity * c.porosity_slope) * (1 - porosity) * a.solid[0] * c.solid.sum();
    return -pi / c.storage * (porosity * c.saturation * a.liquid[0] * c.liquid.sum() + solid);
  }

  /// Force per mass on both phases, over wave().
  struct Forces {
    Vec<dim> solid, liquid;
  };
  Forces forces(const Coefficients& c, Real t) const {
    const Amplitudes a = amplitudes(t);
    const Real n = porosity;
    const Real pressure = -pi * pressure_amplitude(c, a);  // grad p over phi
    const Real divergence = -pi * pi * a.solid[0] * c.solid.sum();
    Forces f;
    for (int i = 0; i < dim; ++i) {
      const Real relative = a.liquid[1] * c.liquid[i] - a.solid[1] * c.solid[i];
      const Real stress =
          (c.lame + c.shear) * divergence - dim * pi * pi * c.shear * a.solid[0] * c.solid[i];
      // grad (S p) - n S grad p
      const Real water =
          (c.saturation + c.pressure * c.pressure_slope - n * c.saturation) * pressure +
          c.pressure * c.porosity_slope * (1 - n) * divergence;
      f.solid[i] =
          a.solid[2] * c.solid[i] -
          (stress - water + n * c.saturation * c.drag * relative) / ((1 - n) * solid_density);
      f.liquid[i] = a.liquid[2] * c.liquid[i] + (pressure + c.drag * relative) / liquid_density;
    }
    return f;
  }

  template <class V>
  auto start(const Resolution& r) const {
    const Coefficients c = coefficients();
    using Model = With<Physics, V>;
    using Solver = vadose::Solver<Model, typename V::Scheme>;
    const Real h = 1.0 / r.cells;
    vadose::Scene<Model> scene({.box = {Vec<dim>::Zero(), Vec<dim>::Constant(1)}, .cell_size = h});
    scene.liquid = {.density = liquid_density, .bulk_modulus = bulk_modulus};
    scene.add_soil(vadose::box<dim>(Vec<dim>::Zero(), Vec<dim>::Constant(1)), material<Model>(),
                   {.liquid_pressure = [p = c.pressure](const Vec<dim>&) { return p; }});
    // Fastest wave: both phases together, or the water between fixed grains.
    const Real stiffness =
        oedometric_modulus(young_modulus, poisson_ratio) + c.saturation * c.saturation / c.storage;
    const Real speed = std::sqrt(stiffness / ((1 - porosity) * solid_density));
    const auto steps = std::ceil(times.front() * speed / (r.courant * h));
    const Real dt = times.front() / steps;
    Solver solver(scene, {.courant = 1, .dt_max = dt, .transfer = {.pic_rate = 0}});
    const Amplitudes a = amplitudes(-0.5 * dt);
    kick(solver.mutable_state().solid, a.solid[1] * c.solid);
    kick(solver.mutable_state().liquid, a.liquid[1] * c.liquid);
    return Driven<Solver>(std::move(solver), dt, [*this, c](Solver& s, Real step) {
      const Forces f = forces(c, s.time());
      kick(s.mutable_state().solid, step * f.solid);
      kick(s.mutable_state().liquid, step * f.liquid);
    });
  }
  template <class Points>
  static void kick(Points& points, const Vec<dim>& change) {
    points.for_each([&](std::size_t b, int l) {
      Vec<dim> x;
      for (int d = 0; d < dim; ++d) x[d] = points.at(vadose::field::position, b, d)[l];
      const Vec<dim> phi = wave(x);
      for (int d = 0; d < dim; ++d)
        points.at(vadose::field::velocity, b, d)[l] += change[d] * phi[d];
    });
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    const Coefficients c = coefficients();
    const Amplitudes a = amplitudes(run.time());
    Comparison displacement{"displacement", time}, pressure{"pressure", time};
    run.solid().for_each([&](std::size_t b, int l) {
      const Vec<dim> x = start_of(run, b, l), phi = wave(x), u = run.displacement(b, l);
      for (int d = 0; d < dim; ++d)
        displacement.add(x[d], u[d] / amplitude, a.solid[0] * c.solid[d] * phi[d] / amplitude);
    });
    const Real scale = std::fabs(pressure_amplitude(c, a));
    for_cells(run, vadose::CellKind::soil, [&](const auto& cell) {
      Vec<dim> x;
      for (int d = 0; d < dim; ++d) x[d] = cell.centroid[d];
      pressure.add(x[0], (cell.pressure - c.pressure) / scale,
                   pressure_amplitude(c, a) * wave_divergence(x) / scale);
    });
    return {displacement, pressure};
  }

  Real bound(const Comparison& c, const Resolution& r) const {
    if (r.cells < 32) return std::numeric_limits<Real>::infinity();
    if (start_saturation == 1) return 0.006;
    // The drag is of first order in time.
    return c.quantity == "pressure" && r.courant > 0.1 ? 0.04 : 0.012;
  }
};

}  // namespace verify

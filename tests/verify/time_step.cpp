// SPDX-License-Identifier: MIT
// The step that the solver takes: equal to C 2/omega, close to the true limit
// of the scheme on aligned points with linear shape functions, stable for every basis at default C.

#include <doctest/doctest.h>

#include "kicked_block.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

using verify::block;
using verify::Dry;
using verify::dry_soil;
using verify::is_stable;
using verify::Moist;
using verify::Wet;
struct Water : vd::FreeWaterModel<vd::Uniaxial> {};

/// Step limit 2/omega of soil with pore water, drag implicit, written out.
Real two_phase_step(Real h, Real stiffness, Real saturation, Real capacity, Real porosity,
                    Real solid_density, Real bulk_modulus) {
  const Real k_star = saturation / (saturation / bulk_modulus + capacity);
  const Real ms = (1 - porosity) * solid_density, ml = 1000;
  const Real tr =
      k_star / ml +
      (stiffness + saturation * (1 - porosity) * (1 - porosity) * k_star / porosity) / ms;
  const Real det = k_star * stiffness / (ms * ml);
  return 2 / std::sqrt(2 / (h * h) * (tr + std::sqrt(tr * tr - 4 * det)));
}

const Real stiffness = verify::oedometric_modulus(10e6, 0.33);

/// Largest stable Courant number, by bisection; 2 if all are stable. shift: moves all points up.
template <class M>
Real critical_courant(const vd::Scene<M>& scene, long steps, Real shift = 0) {
  vd::SolverOptions<M> options;
  options.transfer = {.pic_rate = 0};
  options.displacement_cap = 0.25;
  Real low = 0.1, high = 1.999;
  while (high - low > 0.002) {
    options.courant = 0.5 * (low + high);
    (is_stable(scene, options, steps, 100, shift) ? low : high) = options.courant;
  }
  return low;
}

/// Part of 2/omega at which FLIP with hat functions and k points per cell (lattice) is stable.
/// A sawtooth on the nodes comes back from the points weakened to beta = mean (1 - 2 xi)^2, while
/// the strain takes all of it: u' = u + dt (v + a dt), v' = v + beta a dt. Its amplification matrix
/// has trace 2 - w^2 and determinant 1 - (1 - beta) w^2, w = omega dt: stable to w^2 = 4/(2 - beta).
Real lattice_limit(int k) {
  Real beta = 0;
  for (int i = 0; i < k; ++i) {
    const Real xi = (i + 0.5) / k;
    beta += (1 - 2 * xi) * (1 - 2 * xi) / k;
  }
  return 1 / std::sqrt(2 - beta);
}

}  // namespace

TEST_CASE("time step: formula against the reference table (Table 1 rows)") {
  const verify::Table table("timesteps.csv");
  int compared = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table.text(i, "problem").rfind("4.1", 0) != 0 &&
        table.text(i, "problem").rfind("4.2", 0) != 0)
      continue;
    // The table's K_f is S / (n (S/K + C)).
    const Real k_star = 0.4 * table.number(i, "Kf_Pa"), h = table.number(i, "h_m");
    const Real s = table.number(i, "Sr");
    const Real w2 =
        vd::kernel::two_phase_frequency2(table.number(i, "Eoed_Pa"), k_star, 0.4, s, 2600, 1000, h);
    CAPTURE(table.text(i, "problem"));
    CHECK(verify::close(2 / std::sqrt(w2), table.number(i, "h/c1_free"), 1e-6));
    ++compared;
  }
  CHECK(compared >= 5);
}

TEST_CASE("time step: C 2/omega to 1e-6") {
  using W = Wet<vd::Uniaxial, vd::shape::Gimp>;
  using U = Moist<vd::Uniaxial, vd::shape::Gimp>;
  using D = Dry<vd::Uniaxial, vd::shape::Gimp>;
  const Real exact_wet = two_phase_step(0.1, stiffness, 1, 0, 0.4, 2600, 2.2e9);
  for (const Real c : {0.5, 0.3})
    for (const Real k : {1.0, 1e-3, 1e-12}) {
      vd::Solver<W> wet(block<W>(verify::saturated_soil<W>(k), {}, 0.1, 1, 10), {.courant = c});
      const auto step = wet.step();
      CHECK(verify::close(step.dt, c * exact_wet, 1e-6));
      CHECK(step.limit == vd::StepLimit::two_phase);
    }
  vd::Solver<D> dry(block<D>(dry_soil<D>(), {}, 0.1, 1, 10));
  const auto dry_step = dry.step();
  CHECK(verify::close(dry_step.dt, 0.5 * 0.1 / std::sqrt(stiffness / 1560), 1e-6));
  CHECK(dry_step.limit == vd::StepLimit::skeleton);

  for (const Real s : {1e3, 2e4, 187657.4354}) {
    vd::Solver<U> moist(block<U>(verify::clay<U>(), {.suction = s}, 0.1, 1, 10));
    const auto retention = moist.state().soils[0].material.retention;
    const Real capacity = -retention.saturation_slope(s, 0.4);
    const Real exact = std::min(
        two_phase_step(0.1, stiffness, retention.saturation(s, 0.4), capacity, 0.4, 2600, 2.2e9),
        0.1 / std::sqrt(stiffness / 1560));
    const Real dt = moist.step().dt;
    CAPTURE(s);
    MESSAGE("suction ", s, ": dt over its formula - 1 = ", dt / (0.5 * exact) - 1);
    CHECK(verify::close(dt, 0.5 * exact, 1e-6));
  }

  vd::Scene<Water> scene({.box = {Vec<1>(0.0), Vec<1>(1.0)}, .cell_size = 0.1});
  scene.add_water(vd::box(Vec<1>(0.0), Vec<1>(0.8)),
                  {.liquid_pressure = [](const Vec<1>&) { return 1e4; }});
  vd::Solver<Water> water(scene);
  const auto water_step = water.step();
  CHECK(verify::close(water_step.dt, 0.5 * 0.1 / std::sqrt(2.2e9 / 1000), 1e-6));
  CHECK(water_step.limit == vd::StepLimit::water);
}

// Linear shape functions, FLIP without PIC, 20 cells, k >= 0.01 m/s. One point at the upper node of
// every cell: nothing is lost between points and nodes and the limit is 2/omega itself.
TEST_CASE("time step: measured limit within 5 % of 2/omega, points on nodes") {
  using D = Dry<vd::Uniaxial, vd::shape::Linear>;
  using W = Wet<vd::Uniaxial, vd::shape::Linear>;
  const Real shift = 0.5 * 0.1 * (1 - 1e-9);
  const Real dry =
      critical_courant(block<D>(dry_soil<D>(), {.points_per_cell = 1}, 0.1, 1, 20), 4000, shift);
  MESSAGE("dry: measured / (2/omega) = ", dry);
  CHECK(std::fabs(dry - 1) <= 0.05);
  for (const Real k : {0.01, 1.0, 100.0}) {
    const Real wet = critical_courant(
        block<W>(verify::saturated_soil<W>(k), {.points_per_cell = 1}, 0.1, 1, 20), 4000, shift);
    MESSAGE("saturated, k ", k, " m/s: measured / (2/omega) = ", wet);
    CAPTURE(k);
    CHECK(std::fabs(wet - 1) <= 0.05);
  }
}

TEST_CASE("time step: measured limit within 5 % of 2/omega times the factor of the lattice") {
  using D = Dry<vd::Uniaxial, vd::shape::Linear>;
  using W = Wet<vd::Uniaxial, vd::shape::Linear>;
  for (const int per_cell : {1, 2, 3, 4})
    for (const bool air : {true, false}) {
      CAPTURE(per_cell);
      CAPTURE(air);
      const Real expected = lattice_limit(per_cell);
      const Real dry = critical_courant(
          block<D>(dry_soil<D>(), {.points_per_cell = per_cell}, 0.1, 1, 20, air), 4000);
      const Real wet = critical_courant(
          block<W>(verify::saturated_soil<W>(0.01), {.points_per_cell = per_cell}, 0.1, 1, 20, air),
          4000);
      MESSAGE(per_cell, " per cell", std::string(air ? ", free top" : ", closed"), ": expected ",
              expected, ", dry ", dry, ", saturated ", wet);
      CHECK(verify::close(dry, expected, 0.05));
      CHECK(verify::close(wet, expected, 0.05));
    }
}

// The other bases in 2D and 3D are in tests/long.
TEST_CASE("time step: every basis is stable at the default C, 1D") {
  verify::check_default<vd::Uniaxial, vd::shape::Linear>();
  verify::check_default<vd::Uniaxial, vd::shape::Gimp>();
  verify::check_default<vd::Uniaxial, vd::shape::QuadraticBSpline>();
}
TEST_CASE("time step: GIMP is stable at the default C, 2D") {
  verify::check_default<vd::PlaneStrain, vd::shape::Gimp>();
}
TEST_CASE("time step: GIMP is stable at the default C, 3D") {
  verify::check_default<vd::ThreeDimensional, vd::shape::Gimp>();
}

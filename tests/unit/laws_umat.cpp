// SPDX-License-Identifier: MIT
// Laws written for the UMAT interface, in C and in Fortran, against the same laws written here.

#include <doctest/doctest.h>

#include <vadose/testing/check_law.hpp>

#include "../../examples/laws/von_mises.hpp"
#include "laws_support.hpp"

using namespace laws_test;
using namespace vadose::law;
using vadose::Status;

extern "C" {

#ifdef VADOSE_TEST_FORTRAN
UmatRoutine umat_elastic_, umat_von_mises_;
#endif

/// What the routine saw of its last call.
static struct {
  int ntens, ndi, nshr, nstatv, nprops;
  double dstran[6], stress[6], gradient[9], dt;
  char name[8];
  std::size_t name_length;
} seen;

/// Linear elasticity with its shears in UMAT's order; STATEV(1) counts calls; refuses large strains.
static void umat_in_c(double* stress, double* statev, double* ddsdde, double* /*sse*/,
                      double* /*spd*/, double* /*scd*/, double* /*rpl*/, double* /*ddsddt*/,
                      double* /*drplde*/, double* /*drpldt*/, const double* /*stran*/,
                      const double* dstran, const double* /*time*/, const double* dtime,
                      const double* /*temp*/, const double* /*dtemp*/, const double* /*predef*/,
                      const double* /*dpred*/, const char* cmname, const int* ndi, const int* nshr,
                      const int* ntens, const int* nstatv, const double* props, const int* nprops,
                      const double* /*coords*/, const double* /*drot*/, double* pnewdt,
                      const double* /*celent*/, const double* /*dfgrd0*/, const double* dfgrd1,
                      const int* /*noel*/, const int* /*npt*/, const int* /*layer*/,
                      const int* /*kspt*/, const int* /*kstep*/, const int* /*kinc*/,
                      std::size_t cmname_length) {
  seen = {};
  seen.ntens = *ntens, seen.ndi = *ndi, seen.nshr = *nshr;
  seen.nstatv = *nstatv, seen.nprops = *nprops, seen.dt = *dtime;
  seen.name_length = cmname_length;
  for (int i = 0; i < 7; ++i) seen.name[i] = cmname[i];
  for (int i = 0; i < 9; ++i) seen.gradient[i] = dfgrd1[i];
  for (int i = 0; i < *ntens; ++i) seen.dstran[i] = dstran[i], seen.stress[i] = stress[i];
  const double shear = props[0] / (2 * (1 + props[1]));
  const double lame = 2 * shear * props[1] / (1 - 2 * props[1]);
  for (int i = 0; i < *ntens; ++i) {
    const bool normal = i < *ndi;
    ddsdde[i * *ntens + i] = normal ? lame + 2 * shear : shear;
    stress[i] += (normal ? 2 : 1) * shear * dstran[i] +
                 (normal ? lame * (dstran[0] + dstran[1] + dstran[2]) : 0);
  }
  if (*nstatv > 0) statev[0] += 1;
  if (dstran[0] > 0.5) *pnewdt = 0.25;
}

}  // extern "C"

namespace {

constexpr LinearElastic elastic{.young_modulus = 10e6, .poisson_ratio = 0.3};

template <int Variables>
Umat<Variables> in_c() {
  return {.routine = umat_in_c,
          .properties = {elastic.young_modulus, elastic.poisson_ratio},
          .modulus = elastic.p_wave_modulus(),
          .name = "CLAY"};
}

/// Largest difference of stress and of the first state variable over a path, relative.
template <int N, class A, class B>
Real path_difference(const A& a, const B& b, Real strain) {
  Random random(3);
  auto state_a = initial_state(a);
  auto state_b = initial_state(b);
  Tensor<N> stress_a, stress_b;
  Real worst = 0;
  for (int i = 0; i < 50; ++i) {
    StrainStep<Real, N> step;
    step.increment = random.tensor<N>(strain);
    step.dt = 1e-3;
    REQUIRE(apply(a, step, stress_a, state_a.data()) == Status::ok);
    REQUIRE(apply(b, step, stress_b, state_b.data()) == Status::ok);
    worst = std::max(worst, distance<N>(stress_a, stress_b) / std::max(largest(stress_a), 1.0));
    if constexpr (state_size < A >> 0 && state_size < B >> 0)
      worst = std::max(worst, std::abs(state_a[0] - state_b[0]) / std::max(state_a[0], 1e-6));
  }
  return worst;
}

static_assert(vadose::ConstitutiveLaw<Umat<0>, 3> && vadose::ConstitutiveLaw<Umat<5>, 6>);
static_assert(state_size<Umat<0>> == 0 && state_size<Umat<7>> == 7 && !LaneLaw<Umat<7>, 4>);

}  // namespace

TEST_CASE("UMAT in C: the same stress as the native law, in every dimension") {
  CHECK(path_difference<3>(elastic, in_c<0>(), 1e-3) < 1e-13);
  CHECK(path_difference<4>(elastic, in_c<0>(), 1e-3) < 1e-13);
  CHECK(path_difference<6>(elastic, in_c<2>(), 1e-3) < 1e-13);
}

TEST_CASE("UMAT: order of components, engineering shears, and the other arguments") {
  auto umat = in_c<3>();
  umat.initial = {10, 20};
  Tensor<6> strain, stress;
  for (int i = 0; i < 6; ++i) strain[i] = 1e-3 * (i + 1), stress[i] = 100.0 * (i + 1);
  auto state = umat.initial_state();
  CHECK(state.number[1] == 20);
  after<6>(umat, strain, stress, state);
  CHECK(state.number[0] == 11);
  CHECK(state.number[2] == 0);
  CHECK(seen.ntens == 6);
  CHECK(seen.ndi == 3);
  CHECK(seen.nshr == 3);
  CHECK(seen.nstatv == 3);
  CHECK(seen.nprops == 2);
  CHECK(seen.dt == 1e-3);
  CHECK(seen.name_length == 80);
  CHECK(std::string(seen.name) == "CLAY   ");
  const Real order[6] = {1, 2, 3, 4, 6, 5};  // ours: xx yy zz xy yz zx; theirs: 12 13 23
  for (int i = 0; i < 6; ++i) {
    CHECK(seen.stress[i] == 100 * order[i]);
    CHECK(seen.dstran[i] == doctest::Approx((i < 3 ? 1e-3 : 2e-3) * order[i]).epsilon(1e-14));
  }
  CHECK(seen.gradient[0] == 1.001);
  CHECK(seen.gradient[1] == doctest::Approx(0.004));
  CHECK(seen.gradient[2] == doctest::Approx(0.006));  // 13 = zx
  CHECK(seen.gradient[5] == doctest::Approx(0.005));  // 23 = yz
  Tensor<4> plane;
  plane[3] = 1e-3;
  after<4>(in_c<0>(), plane, Tensor<4>{});
  CHECK(seen.ntens == 4);
  CHECK(seen.nshr == 1);
  CHECK(seen.nstatv == 0);
  CHECK(seen.dstran[3] == 2e-3);
}

TEST_CASE("UMAT: a smaller step asked for is a failed step; bad set-ups are refused") {
  Umat<0> umat = in_c<0>();
  StrainStep<Real, 3> step;
  step.increment[0] = 0.6;
  Tensor<3> stress;
  Umat<0>::State none;
  CHECK(umat.update(step, stress, none) == Status::failed);
  CHECK(complaint(umat) == "accepted");
  umat.initial = {1};
  CHECK(contains(complaint(umat), "number of initial state variables = 1 outside [0, 0]"));
  umat.initial.clear();
  umat.modulus = vadose::unset;
  CHECK(contains(complaint(umat), "modulus"));
  umat.modulus = 1e6;
  umat.routine = nullptr;
  CHECK(contains(complaint(umat), "routine = (missing)"));
}

TEST_CASE("UMAT: passes the checks of laws") {
  const auto report = vadose::testing::check_law(in_c<0>());
  INFO(report.text());
  CHECK(report.ok());
}

TEST_CASE("UMAT in Fortran: linear elasticity and von Mises as the native laws") {
#ifdef VADOSE_TEST_FORTRAN
  const Umat<0> fortran_elastic{.routine = umat_elastic_,
                                .properties = {elastic.young_modulus, elastic.poisson_ratio},
                                .modulus = elastic.p_wave_modulus()};
  CHECK(path_difference<3>(elastic, fortran_elastic, 1e-3) < 1e-13);
  CHECK(path_difference<4>(elastic, fortran_elastic, 1e-3) < 1e-13);
  CHECK(path_difference<6>(elastic, fortran_elastic, 1e-3) < 1e-13);
  const VonMises mises{.elastic = elastic, .undrained_strength = 20e3};
  const Umat<1> fortran_mises{.routine = umat_von_mises_,
                              .properties = {elastic.young_modulus, elastic.poisson_ratio, 20e3},
                              .modulus = elastic.p_wave_modulus(),
                              .name = "CLAY"};
  CHECK(path_difference<3>(mises, fortran_mises, 5e-3) < 1e-11);
  CHECK(path_difference<4>(mises, fortran_mises, 5e-3) < 1e-11);
  CHECK(path_difference<6>(mises, fortran_mises, 5e-3) < 1e-11);
  const auto report = vadose::testing::check_law(fortran_mises);
  INFO(report.text());
  CHECK(report.ok());
  auto nameless = fortran_mises;  // the routine asks for its material's name
  nameless.name = "SAND";
  StrainStep<Real, 3> step;
  Tensor<3> stress;
  Umat<1>::State state;
  CHECK(nameless.update(step, stress, state) == Status::failed);
#else
  MESSAGE("no Fortran compiler: the routines in tests/umat are skipped");
#endif
}

// SPDX-License-Identifier: MIT
// Checkpoints: same bits after a restart, and nothing but a clear error from a file that is damaged,
// cut off, hostile, or of another run.

#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>
#include <vector>

#include <vadose/io/vtk_series.hpp>

#include "../error_message.hpp"
#include "../seepage.hpp"
#include "../slope.hpp"
#include "restart_support.hpp"

namespace {

namespace vd = vadose;
using namespace restart_test;
using vadose_test::error_message;
using vd::Face;
using vd::Real;

using vadose_test::Slope;
using vadose_test::Temperature;
using Column = vadose_test::Seepage<vd::Uniaxial>;

vd::Material<Slope> sand() {
  return {.name = "sand",
          .solid_density = 2650,
          .porosity = 0.4,
          .lambda = 0.63,
          .skeleton = {.elastic = {.young_modulus = 2e6, .poisson_ratio = 0.3},
                       .cohesion = 500,
                       .friction_angle = vd::degrees(35)},
          .retention = {.a = 3},
          .conductivity = {.saturated_conductivity = 1e-4}};
}

/// Heavy rain on a slope beside a pond that runs out of the box: films, free water that comes and
/// goes, a load, two soils, a switched drain.
vd::Scene<Slope> slope() {
  vd::Scene<Slope> scene({.box = {{0.0, 0.0}, {1.2, 0.8}}, .cell_size = 0.1});
  scene.gravity = {0, -9.81};
  scene.liquid.bulk_modulus = 1e6;
  auto firm = sand();
  firm.name = "firm";
  firm.skeleton.elastic.young_modulus = 5e6;
  scene.add_soil(vd::box({0.0, 0.0}, {1.2, 0.1}), firm, {.saturation = 0.6});
  scene.add_soil(vd::polygon({{0, 0.1}, {0.8, 0.1}, {0.4, 0.4}, {0, 0.4}}), sand(),
                 {.saturation = 0.6});
  scene.add_water(vd::box({0.9, 0.1}, {1.1, 0.3}), {.velocity = {1, 0}});
  scene.add(vd::bc::Fixed{.face = Face::bottom});
  scene.add(vd::bc::Traction<2>{.region = vd::box({0.0, 0.35}, {0.3, 0.4}),
                                .traction = {0, -1e3},
                                .time_factor = [](Real t) { return t; }});
  scene.add(vd::bc::Drain{.face = Face::right, .active = [](Real t) { return t > 0.02; }});
  scene.add(vd::bc::Rain{.rate = 0.2});
  return scene;
}
const vd::SolverOptions<Slope> open_box{.dt_max = 2e-3, .escaped = vd::Escape::outflow};

vd::Scene<Column> column(int points = 4, Real porosity = 0.4) {
  vd::Scene<Column> scene({.box = {{0.0}, {1.0}}, .cell_size = 0.1});
  scene.gravity[0] = -9.81;
  scene.liquid.bulk_modulus = 1e6;
  scene.add_soil(vd::box({0.0}, {0.8}),
                 {.name = "sand",
                  .porosity = porosity,
                  .lambda = 0.63,
                  .retention = {.a = 3},
                  .conductivity = {.saturated_conductivity = 1e-4}},
                 {.points_per_cell = points, .saturation = 0.5});
  scene.add(vd::bc::Drained{.face = Face::bottom, .active = [](Real t) { return t > 0.1; }});
  scene.add(vd::bc::Rain{.rate = 1e-3});
  return scene;
}

using Run = vd::Solver<Slope>;

}  // namespace

TEST_CASE("restart: same bits for rain on a slope, also right after points came or went") {
  // What has to happen before the run is saved, and after how many steps at most it does.
  const auto reached = [](Run& run, auto&& event) {
    for (int i = 0; i < 4000; ++i) {
      const std::size_t before = run.liquid().size();
      REQUIRE(run.step().status == vd::Status::ok);
      if (event(run, before)) return;
    }
    FAIL("the event does not come");
  };
  Run run(slope(), open_box), other(slope(), open_box);
  for (std::size_t b = 0; b < run.solid().batches(); ++b)
    for (int l = 0; l < vd::lane_count; ++l)
      run.mutable_state().solid.at(Temperature{}, b, 1)[l] = run.solid().at(vd::field::id, b)[l];
  check_taken_up(run, other, 50);  // before the first step
  reached(run, [](const Run& r, std::size_t) { return r.state().slack > 0; });
  check_taken_up(run, other, 50);
  reached(run, [](const Run& r, std::size_t) { return r.liquid().has_new(); });
  check_taken_up(run, other, 50);
  reached(run, [](const Run& r, std::size_t before) { return r.liquid().size() < before; });
  check_taken_up(run, other, 200);
  const auto w = run.water_balance();
  MESSAGE("rain ", w.rain, " kg, film ", w.film, ", free ", w.free, ", lost ", w.lost);
  CHECK(w.film > 0);
  CHECK(w.lost > 0);
  int wrong = 0;  // the host's field rides along
  other.solid().for_each([&](std::size_t b, int l) {
    wrong += other.solid().at(Temperature{}, b, 1)[l] != other.solid().at(vd::field::id, b)[l];
  });
  CHECK(wrong == 0);
}

TEST_CASE("restart: same bits for seepage with a switched drain; output and displacements too") {
  using S = vd::Solver<Column>;
  check_restart<S>(column(), {}, 40, 400);

  Run run(slope(), open_box), other(slope(), open_box);
  REQUIRE(steps(run, 60));
  const TemporaryDirectory directory("checkpoint", true);
  vd::io::save_checkpoint(directory / "run", run);
  vd::io::load_checkpoint(directory / "run", other);
  CHECK(other.time() == run.time());
  CHECK(other.last_step().text() == run.last_step().text());
  vd::io::VtkSeries(directory / "a").write(run);
  vd::io::VtkSeries(directory / "b").write(other);
  for (const char* phase : {"_solid_000000.vtp", "_liquid_000000.vtp"})
    CHECK(file_bytes(directory / ("a" + std::string(phase))) ==
          file_bytes(directory / ("b" + std::string(phase))));
}

TEST_CASE("restart: same bits while points of free water merge and split, beside a reservoir") {
  auto scene = slope();
  scene.add(vd::bc::Reservoir{.face = Face::left, .function = [](Real t) { return 0.2 + t; }});
  auto options = open_box;
  options.resampling.on = true;
  Run run(scene, options), other(scene, options);
  REQUIRE(steps(other, 3));
  for (int i = 0; i < 25; ++i) {
    CAPTURE(run.steps());
    check_taken_up(run, other, 12);
  }
}

TEST_CASE("checkpoint: points that the host puts in and takes out") {
  Run run(slope(), open_box), other(slope(), open_box);
  REQUIRE(steps(run, 20));
  const vd::SolidBalance before = run.solid_balance();
  vd::Scene<Slope> fill({.box = {{0.0, 0.0}, {1.2, 0.8}}, .cell_size = 0.1});
  fill.gravity = {0, -9.81};
  fill.liquid.bulk_modulus = 1e6;
  fill.add_soil(vd::box({0.0, 0.5}, {0.2, 0.6}), sand(), {.saturation = 0.5});
  fill.add_water(vd::box({0.5, 0.5}, {0.6, 0.6}));
  const vd::PointCount put = run.add_points(fill);
  CHECK(put.solid == 8);
  CHECK(put.liquid == 12);
  CHECK(run.solid_balance().added == doctest::Approx(2650 * 0.6 * 0.02).epsilon(1e-12));
  CHECK(run.water_balance().added == doctest::Approx(1000 * (0.2 * 0.02 + 0.01)).epsilon(3e-3));
  const vd::PointCount gone = run.remove_points(vd::box({0.0, 0.3}, {0.15, 0.4}));
  CHECK(gone.solid > 0);
  CHECK(gone.liquid >= gone.solid);
  CHECK(run.solid_balance().stored < before.stored + 2650 * 0.6 * 0.02);
  CHECK(run.state().loads.size() < other.state().loads.size());
  check_taken_up(run, other, 50);
  CHECK(std::fabs(run.water_balance().relative_closure()) < 1e-12);
  CHECK(std::fabs(run.solid_balance().relative_closure()) < 1e-12);
  run.solid().for_each([&](std::size_t b, int l) { CHECK(run.displacement(b, l).norm() < 0.1); });

  vd::Scene<Slope> foreign({.box = {{0.0, 0.0}, {1.2, 0.8}}, .cell_size = 0.1});
  auto clay = sand();
  clay.name = "clay";
  foreign.add_soil(vd::box({0.0, 0.5}, {0.2, 0.6}), clay, {.saturation = 0.5});
  const TemporaryDirectory directory("checkpoint", true);
  const std::string bytes = bytes_of(run, directory);
  CHECK(error_message<vd::SetupError>([&] { run.add_points(foreign); }) ==
        "material 'clay' outside {'firm', 'sand'} of the run: its points cannot be added");
  CHECK(bytes_of(run, directory) == bytes);
}

TEST_CASE("checkpoint: a file of another run is refused, by the first thing that differs") {
  const TemporaryDirectory directory("checkpoint", true);
  vd::Solver<Column> run(column());
  REQUIRE(steps(run, 10));
  vd::io::save_checkpoint(directory / "run", run);
  const auto refusal = [&](auto&& solver) {
    const std::string before = bytes_of(solver, directory);
    const std::string message = error_message<vd::io::InputError>(
        [&] { vd::io::load_checkpoint(directory / "run", solver); });
    CHECK(bytes_of(solver, directory) == before);
    const std::string start =
        "cannot read checkpoint '" + (directory / "run") + "': it is of another run: ";
    REQUIRE(message.substr(0, start.size()) == start);
    return message.substr(start.size());
  };
  CHECK(refusal(Run(slope(), open_box)) == "dimension is 1 in the file, 2 in the run");
  CHECK(refusal(vd::Solver<Column>(column(4, 0.45))) ==
        "porosity of material 'sand' is 0.4 in the file, 0.45 in the run");
  auto scene = column();
  scene.gravity[0] = -10;
  CHECK(refusal(vd::Solver<Column>(scene)) ==
        "gravity along axis 0 is -9.81 in the file, -10 in the run");
  scene = column();
  scene.liquid.bulk_modulus = 2e6;
  CHECK(refusal(vd::Solver<Column>(scene)) ==
        "liquid bulk modulus is 1000000 in the file, 2000000 in the run");
  scene = column();
  scene.add(vd::bc::Impermeable{.region = vd::box({0.0}, {0.1})});
  CHECK(refusal(vd::Solver<Column>(scene)) ==
        "number of liquid conditions is 2 in the file, 3 in the run");
  // Points per cell are state, not scene: such a file is taken.
  vd::Solver<Column> finer(column(8));
  vd::io::load_checkpoint(directory / "run", finer);
  CHECK(finer.solid().size() == run.solid().size());
}

TEST_CASE("checkpoint: files that cannot be written or read are clear errors") {
  const TemporaryDirectory directory("checkpoint", true);
  vd::Solver<Column> run(column());
  vd::io::save_checkpoint(directory / "run", run);
  const std::string good = file_bytes(directory / "run");
  const auto load_error = [&](const std::string& path) {
    return error_message<vd::io::InputError>([&] { vd::io::load_checkpoint(path, run); });
  };
  CHECK(load_error(directory / "none") ==
        "cannot read checkpoint '" + (directory / "none") + "': No such file or directory");
  CHECK(load_error(directory.path.string()).find("cannot read checkpoint") == 0);
  const auto about = [&](std::string bytes) {
    write_bytes(directory / "bad", bytes);
    const std::string message = load_error(directory / "bad");
    return message.substr(message.find("bad") + 4);
  };
  CHECK(about("") == ": the file is too short");
  CHECK(about("<VTKFile" + good) == ": it is no checkpoint of this library");
  std::string other = good;
  std::swap(other[8], other[11]);
  CHECK(about(other) == ": it was written with another order of bytes");
  other = good;
  other[12] = 9;
  CHECK(about(other) == ": its version is 9, this library reads version 5");
  CHECK(about(good.substr(0, good.size() - 1)).find("bytes, ") != std::string::npos);
  other = good;
  other[other.find("solid points") + 200] ^= 1;
  CHECK(about(other) == ": section 'solid points' is damaged");
  // A full disk: the old file stays and the run can go on.
  std::filesystem::create_symlink("/dev/full", directory / "run.part");
  CHECK(error_message<vd::io::OutputError>([&] {
          vd::io::save_checkpoint(directory / "run", run);
        }) == "cannot write file '" + (directory / "run.part") + "': No space left on device");
  CHECK(file_bytes(directory / "run") == good);
  CHECK(steps(run, 10));
}

namespace {

/// Reactions to damaged files.
struct FuzzCount {
  int tried = 0, refused = 0, accepted = 0;
};

/// Seconds that the environment asks each fuzzing to go on for; 0 by default.
Real fuzz_seconds() {
  const char* given = std::getenv("VADOSE_FUZZ_SECONDS");
  return given ? std::strtod(given, nullptr) : 0;
}

/// Writes damaged copies of a file, at least so many, and takes them up: each is refused with InputError
/// and leaves the solver as it was, or is taken and the solver can step. `repair`: the checksums are made
/// good again, so that the damage reaches the values.
template <class S>
FuzzCount fuzz(S run, int files, unsigned seed, bool repair) {
  using vd::io::detail::CheckpointHead;
  using vd::io::detail::checksum;
  using vd::io::detail::SectionHead;
  const TemporaryDirectory directory("fuzz", true);
  const std::string good = bytes_of(run, directory);
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return random() % n; };
  FuzzCount count;
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<Real>(fuzz_seconds());
  for (int i = 0; i < files || Clock::now() < end; ++i) {
    std::string bad = good;
    const int kind = static_cast<int>(below(5));
    if (kind == 0 && !repair) {
      bad.resize(below(good.size()));
    } else if (kind == 1 && !repair) {
      bad.insert(below(good.size()), 1 + below(64), static_cast<char>(below(256)));
    } else {
      const std::size_t times = 1 + below(4);
      for (std::size_t k = 0; k < times; ++k) {
        const std::size_t at = below(bad.size());
        if (kind == 2)
          bad[at] = static_cast<char>(below(256));
        else if (kind == 3)
          for (std::size_t j = at / 8 * 8; j < std::min(at / 8 * 8 + 8, bad.size()); ++j)
            bad[j] = below(2) ? '\xff' : static_cast<char>(below(256));
        else
          bad[at] = static_cast<char>(bad[at] ^ (1 << below(8)));
      }
    }
    if (bad == good) continue;
    if (repair) {
      std::size_t at = sizeof(CheckpointHead);
      std::memcpy(bad.data(), good.data(), at);
      std::size_t from = at;
      while (from < good.size()) {  // the heads of the sections as they were, with new checksums
        SectionHead head;
        std::memcpy(&head, good.data() + from, sizeof head);
        head.check = checksum(bad.data() + from + sizeof head, head.bytes);
        head.head_check = checksum(&head, offsetof(SectionHead, head_check));
        std::memcpy(bad.data() + from, &head, sizeof head);
        from += sizeof head + head.bytes;
      }
      if (bad == good) continue;
    }
    write_bytes(directory / "bad", bad);
    ++count.tried;
    S solver = run;
    try {
      vd::io::load_checkpoint(directory / "bad", solver);
      ++count.accepted;
      steps(solver, 2);  // may fail, must not crash
    } catch (const vd::io::InputError&) {
      ++count.refused;
      if (i % 50 == 0) CHECK(bytes_of(solver, directory) == good);
    }
  }
  return count;
}

void check_fuzz(int files) {
  vd::Solver<Column> small(column(1));
  REQUIRE(steps(small, 100));
  Run large(slope(), open_box);
  REQUIRE(steps(large, 100));
  const FuzzCount damaged = fuzz(small, files, 1, false);
  CHECK(damaged.accepted == 0);
  CHECK(damaged.refused > files / 2);
  const FuzzCount hostile = fuzz(small, files, 2, true),
                  hostile2 = fuzz(large, files / 10, 3, true);
  CHECK(hostile.refused > files / 10);
  CHECK(hostile2.refused > 0);
  const auto text = [](const FuzzCount& c) {
    return std::to_string(c.tried) + " tried, " + std::to_string(c.refused) + " refused, " +
           std::to_string(c.accepted) + " taken";
  };
  MESSAGE("damaged: ", text(damaged), "; hostile with good checksums: ", text(hostile), "; ",
          text(hostile2));
}

}  // namespace

TEST_CASE("checkpoint: no damaged or hostile file does harm") {
  check_fuzz(300);
}

TEST_SUITE("long") {
  TEST_CASE("checkpoint: no damaged or hostile file does harm, many files") {
    check_fuzz(40000);
  }
}

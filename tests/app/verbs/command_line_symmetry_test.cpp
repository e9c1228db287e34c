#include <cmath>

#include "core/base/numbers/random.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "tests/command_line.h"

// The verb `test` of organs that are symmetric in themselves.

using namespace homolog;

namespace {

/// Bodies that are symmetric across x = 0 but for noise, and for a bump of `bump_mm` on their left side.
void put_bodies(const fs::path& folder, double bump_mm, double own_mm) {
  Random random(4);
  fs::create_directory(folder);
  for (int k = 0; k < 10; ++k) {
    Mesh body = icosphere(3, 1);
    const double size = 1 + 0.05 * random.normal(), own = own_mm * random.normal();
    for (Eigen::Index v = 0; v < body.points.rows(); ++v) {
      const Vec3 p = body.points.row(v);
      const double left = std::exp(-(p - Vec3(-0.8, 0.4, 0.4)).squaredNorm() / 0.1);
      body.points.row(v) = size * Vec3(30 * p.x(), 20 * p.y() + 6 * p.x() * p.x(), 12 * p.z() + 7 * p.y() * p.y());
      body.points(v, 2) += (bump_mm + own) * left + 0.02 * random.normal();
    }
    REQUIRE(write_mesh(body, folder / ("c" + std::to_string(k) + ".ply")));
  }
}

}  // namespace

TEST_CASE("object symmetry: a bump that all have on one side is directional, one that each has its own is individual") {
  const TemporaryFolder folder;
  put_bodies(folder.path / "directed", 1.5, 0);
  const Ran ran = run(folder, "test directed --object-symmetry --json --csv out");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json directed = ran.json();
  CHECK(directed["formula"] == "shape ~ mirrored");
  CHECK(directed["shapes"] == 20);
  CHECK(directed["terms"][0]["p"].get<double>() <= 0.005);
  CHECK(directed["taken_out"][0]["name"] == "factor(case)");
  CHECK(directed["taken_out"][0]["df"] == 9);
  CHECK(directed["symmetry_off_mm"].get<double>() < 0.5);
  REQUIRE(directed["subjects"].size() == 10);
  for (const Json& one : directed["subjects"])
    CHECK(one["individual_mm"].get<double>() < one["difference_mm"].get<double>() / 3);
  CHECK(lines(read_whole_file(folder.path / "out/subjects.csv").value_or("")) == 11);
  CHECK(lines(read_whole_file(folder.path / "out/cases.csv").value_or("")) == 21);
  // Sums add up: individuals, direction, and what is left, the individuals' own asymmetry.
  const double sum = directed["taken_out"][0]["ss"].get<double>() + directed["terms"][0]["ss"].get<double>() +
                     directed["residual"]["ss"].get<double>();
  CHECK(sum == doctest::Approx(directed["total"]["ss"].get<double>()).epsilon(1e-9));

  put_bodies(folder.path / "own", 0, 1.5);
  const Json own = run(folder, "test own --object-symmetry --json").json();
  CHECK(own["terms"][0]["p"].get<double>() > 0.05);
  double individual = 0;
  for (const Json& one : own["subjects"]) individual += one["individual_mm"].get<double>() / 10;
  CHECK(individual > 0.1);

  // Symmetric but for noise: no direction, though the vertices lie nowhere symmetrically.
  put_bodies(folder.path / "even", 0, 0);
  CHECK(run(folder, "test even --object-symmetry --json").json()["terms"][0]["p"].get<double>() > 0.05);
  CHECK(run(folder, "test even --object-symmetry --no-align").status == 2);
}

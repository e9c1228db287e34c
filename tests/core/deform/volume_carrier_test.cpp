#include "core/deform/volume_carrier.h"

#include <doctest/doctest.h>

#include <fstream>

#include "core/base/files/files.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"
#include "tests/tetrahedra.h"
#include "tests/thread_limit.h"

using namespace homolog;

namespace {

struct BallInFile {
  TemporaryFolder folder;
  Mesh surface = icosphere(2, 20);
  BallOfTetrahedra ball{surface, 4};
  VolumeMesh mesh = read("ball.vtu", ball.vtu());

  VolumeMesh read(const std::string& name, const std::string& bytes) const { return test::must(try_read(name, bytes)); }
  Result<VolumeMesh> try_read(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder.path / name, std::ios::binary) << bytes;
    return read_volume_mesh(folder.path / name);
  }
};

std::string without(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from), end = text.find(to, at);
  REQUIRE(at != std::string::npos);
  REQUIRE(end != std::string::npos);
  return text.erase(at, end - at);
}

}  // namespace

TEST_CASE("the scaled Jacobian is 1 of a regular tetrahedron and negative of one that is turned over") {
  Points points(4, 3);
  points << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
  Tetrahedra elements(3, 4);
  elements << 0, 1, 2, 3, 0, 1, 3, 2, 0, 0, 1, 2;
  const VertexScalars values = scaled_jacobians(elements, points);
  CHECK(std::abs(std::abs(values[0]) - 1) < 1e-12);
  CHECK(values[0] == doctest::Approx(-values[1]));
  CHECK(values[2] == doctest::Approx(0));
  points.row(3) *= 0.1;  // nearer to the face of the others
  CHECK(std::abs(scaled_jacobians(elements, points)[0]) < 0.9);
}

TEST_CASE("tetrahedra follow a similarity of the template exactly") {
  const BallInFile file;
  const VolumeCarrier carrier = test::must(VolumeCarrier::make(file.mesh, file.surface));
  const Eigen::Matrix3d turn = 1.3 * Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::RowVector3d shift(30, -20, 5);
  const Points shape = (file.surface.points * turn.transpose()).rowwise() + shift;
  const CarriedVolume carried = test::must(carrier.carry(shape, nullptr));
  const Points expected = (file.mesh.points * turn.transpose()).rowwise() + shift;
  CHECK((carried.points - expected).cwiseAbs().maxCoeff() < 1e-3);
  CHECK(carried.least == doctest::Approx(carrier.least()).epsilon(1e-3));
  CHECK(carried.slid_mm == 0);
  CHECK(carried.inverted == 0);
}

TEST_CASE("a bent shape turns no tetrahedron over and none is poor") {
  const BallInFile file;
  const VolumeCarrier carrier = test::must(VolumeCarrier::make(file.mesh, file.surface));
  CHECK(carrier.asked() <= 0.2);
  CHECK(carrier.asked() == std::min(0.2, 0.8 * carrier.least()));
  for (const double amount : {0.01, 0.02, 0.03}) {
    CAPTURE(amount);
    const Points shape = bent(file.surface.points, amount);
    const CarriedVolume carried = test::must(carrier.carry(shape, nullptr));
    CHECK(carried.inverted == 0);
    CHECK(carried.poor == 0);
    CHECK(carried.least >= carrier.asked());
    CHECK(carried.lifted_mm < 0.5);
    if (carried.slid_mm == 0) CHECK(carried.points.bottomRows(shape.rows()).isApprox(shape, 1e-5));
  }
}

TEST_CASE("an outside that lies off the template keeps its distance in a larger shape") {
  const BallInFile file;
  const Mesh inner{file.surface.topology, file.surface.points * 0.97};
  const VolumeCarrier carrier = test::must(VolumeCarrier::make(file.mesh, inner));
  CHECK(carrier.off_mm() == doctest::Approx(0.6).epsilon(0.02));
  CHECK_FALSE(carrier.is_far_off());
  const Mesh farther_in{file.surface.topology, file.surface.points * 0.95};
  CHECK(test::must(VolumeCarrier::make(file.mesh, farther_in)).is_far_off());
  const CarriedVolume carried = test::must(carrier.carry(inner.points * 2, nullptr));
  CHECK((carried.points - 2 * file.mesh.points).cwiseAbs().maxCoeff() < 0.02);
  const Mesh other{file.surface.topology, file.surface.points * 0.6};
  CHECK(says(VolumeCarrier::make(file.mesh, other), "not of this template"));
  const Mesh far{file.surface.topology, file.surface.points.rowwise() + Eigen::RowVector3d(100, 0, 0)};
  CHECK(says(VolumeCarrier::make(file.mesh, far), "up to 100 mm off"));
  const Mesh farther{file.surface.topology, file.surface.points.rowwise() + Eigen::RowVector3d(21380, 0, 0)};
  CHECK(says(VolumeCarrier::make(file.mesh, farther), "up to 21380 mm off"));
  CHECK(says(carrier.carry(icosphere(1, 20).points, nullptr), "42 vertices and the template 162"));
}

TEST_CASE("carried tetrahedra are the same bits whatever the threads") {
  const BallInFile file;
  const VolumeCarrier carrier = test::must(VolumeCarrier::make(file.mesh, file.surface));
  const Points shape = bent(file.surface.points, 0.03);
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return test::must(carrier.carry(shape, nullptr)).points;
  };
  CHECK(with(1) == with(4));
}

TEST_CASE("a volume mesh is written again with all but its points byte for byte") {
  const BallInFile file;
  for (const bool ras : {false, true}) {
    const std::string before = file.ball.vtu(ras);
    const VolumeMesh mesh = file.read("in.vtu", before);
    CHECK((mesh.points - file.ball.points).cwiseAbs().maxCoeff() < 1e-6);
    const Points moved = mesh.points.array() + 1.25;
    REQUIRE(write_volume_mesh(mesh, moved, file.folder.path / "out.vtu"));
    const std::string after = read_whole_file(file.folder.path / "out.vtu").value();
    CHECK(without(before, "<Points>", "</Points>") == without(after, "<Points>", "</Points>"));
    CHECK(test::must(read_volume_mesh(file.folder.path / "out.vtu")).points == moved);
  }
  const std::string before = file.ball.msh();
  const VolumeMesh mesh = file.read("in.msh", before);
  const Points moved = mesh.points.array() - 1.0 / 3;
  REQUIRE(write_volume_mesh(mesh, moved, file.folder.path / "out.msh"));
  const std::string after = read_whole_file(file.folder.path / "out.msh").value();
  CHECK(without(before, "$Nodes", "$EndNodes") == without(after, "$Nodes", "$EndNodes"));
  CHECK(after.find("1 4.5\n$EndElementData") != std::string::npos);
  CHECK(test::must(read_volume_mesh(file.folder.path / "out.msh")).points == moved);
}

TEST_CASE("a volume mesh is written again whatever its XML looks like") {
  const BallInFile file;
  const auto changed = [](std::string bytes, const std::string& what, const std::string& by) {
    const std::size_t at = bytes.find(what);
    REQUIRE(at != std::string::npos);
    return bytes.replace(at, what.size(), by);
  };
  const std::string whole = file.ball.vtu(), piece = "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points>",
                    array = "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">",
                    cell =
                        "<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>"
                        "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray><DataArray "
                        "type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells></Piece>";
  const std::string two = "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>" + piece + "<!-- </Points> -->" +
                          array + "0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points >" + cell + piece + array +
                          "5 0 0 6 0 0 5 1 0 5 0 1</DataArray></Points>" + cell + "</UnstructuredGrid></VTKFile>";
  for (const std::string& before :
       {changed(whole, "</Points>", "</Points\n >"), changed(whole, "<Points>", "<Points><!-- </Points> -->"),
        changed(whole, "<Points>", "<Points a=\"</Points>\"><b/>"),
        changed(whole, "</Points>", "<![CDATA[</Points>]]></Points>"), two}) {
    const VolumeMesh mesh = file.read("in.vtu", before);
    const Points moved = mesh.points.array() + 1.25;
    REQUIRE(write_volume_mesh(mesh, moved, file.folder.path / "out.vtu"));
    const VolumeMesh again = test::must(read_volume_mesh(file.folder.path / "out.vtu"));
    CHECK(again.points == moved);
    CHECK(again.tetrahedra == mesh.tetrahedra);
  }
}

TEST_CASE("tetrahedra that are listed twice are carried once and written as they were") {
  const BallInFile file;
  BallOfTetrahedra doubled = file.ball;
  doubled.tetrahedra = file.ball.tetrahedra.replicate(2, 1).eval();
  const VolumeMesh mesh = file.read("in.vtu", doubled.vtu());
  CHECK(mesh.tetrahedra == file.ball.tetrahedra);
  CHECK(on_outside(mesh) == on_outside(file.mesh));
  REQUIRE(mesh.warnings.size() == 1);
  CHECK(mesh.warnings[0].find("3200 of 6400 tetrahedra again") != std::string::npos);
  REQUIRE(write_volume_mesh(mesh, mesh.points, file.folder.path / "out.vtu"));
  const std::string after = read_whole_file(file.folder.path / "out.vtu").value();
  CHECK(without(doubled.vtu(), "<Points>", "</Points>") == without(after, "<Points>", "</Points>"));
}

TEST_CASE("values that may be directions are told of in both formats") {
  const BallInFile file;
  for (const char* kind : {"NodeData", "ElementData", "ElementNodeData"})
    for (const std::string components : {"1", "3", "9"}) {
      const std::string name = kind,
                        section = "$" + name + "\n1\n\"fibres\"\n1\n0\n3\n0\n" + components + "\n0\n$End" + name + "\n";
      const VolumeMesh mesh = file.read("a.msh", file.ball.msh() + section);
      REQUIRE(mesh.warnings.size() == (components == "1" ? 0 : 1));
      if (components != "1") CHECK(mesh.warnings[0].find("1 arrays of three or nine values") != std::string::npos);
    }
  std::string tensors = file.ball.vtu();
  tensors.insert(tensors.find("</CellData>"),
                 "<DataArray type=\"Float64\" Name=\"t\" NumberOfComponents=\"9\" format=\"ascii\"></DataArray>");
  CHECK(file.read("a.vtu", tensors).warnings.size() == 1);
}

TEST_CASE("volume meshes that are wrong are refused by a sentence") {
  const BallInFile file;
  const std::string whole = file.ball.vtu();
  const auto changed = [&](const std::string& what, const std::string& by) {
    std::string bytes = whole;
    const std::size_t at = bytes.find(what);
    REQUIRE(at != std::string::npos);
    return bytes.replace(at, what.size(), by);
  };
  CHECK(says(file.try_read("a.ply", "ply"), "use .vtu or .msh"));
  CHECK(says(file.try_read("a.vtu", changed(">10 10 10 ", ">10 12 10 ")), "hexahedra"));
  CHECK(says(file.try_read("a.vtu", changed(">10 10 10 ", ">10 14 10 ")), "pyramids"));
  CHECK(says(file.try_read("a.vtu", whole.substr(0, whole.size() / 2)), "a.vtu"));
  BallOfTetrahedra turned = file.ball;
  turned.tetrahedra.row(5).head<2>().reverseInPlace();
  CHECK(says(file.try_read("a.vtu", turned.vtu()), "1 of 3200 tetrahedra that are flat or turned over"));
  BallOfTetrahedra all_turned = file.ball;
  all_turned.tetrahedra.col(0).swap(all_turned.tetrahedra.col(1));
  CHECK(file.try_read("b.vtu", all_turned.vtu()));
}

TEST_CASE("a mesh in metres or of a part of the template is refused with what it seems to be") {
  const BallInFile file;
  const auto carried = [&](const Points& points, const Mesh& the_template) {
    VolumeMesh mesh = file.mesh;
    mesh.points = points;
    return VolumeCarrier::make(mesh, the_template);
  };
  // A template whose surface goes through the origin, so that a tiny mesh lies on it.
  const Mesh beside{file.surface.topology, file.surface.points.rowwise() - file.surface.points.row(0)};
  CHECK(says(carried(file.mesh.points / 1000, beside),
             "has an outside 0.001 times as large as the template, as a mesh in metres has; write it in mm (its "
             "coordinates times 1000)"));
  CHECK(says(carried(file.mesh.points / 10, file.surface),
             "as a mesh in cm has; write it in mm (its coordinates times 10)"));
  CHECK(says(carried(file.mesh.points * 1000, file.surface), "as a mesh in micrometres has"));
  Points small = file.mesh.points / 8;
  small.rowwise() += file.surface.points.row(0);
  CHECK(
      says(carried(small, file.surface), "has an outside 0.125 times as large as the template, so it is not of this"));
  CHECK(carried(file.mesh.points * 0.97, file.surface).has_value());
  const auto outside = outside_of(file.mesh);
  REQUIRE(outside);
  CHECK(outside->points.rows() == 162);
  CHECK(outside->topology->triangles().rows() == file.surface.topology->triangles().rows());
}

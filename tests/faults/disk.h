#pragma once

#include <doctest/doctest.h>

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "core/base/files/files.h"
#include "core/case/document.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "core/volume/volume_io.h"
#include "tests/beating_ball.h"
#include "tests/driver.h"
#include "tests/faults/failing_disk.h"
#include "tests/must.h"

namespace homolog {

namespace fs = std::filesystem;

/// How often a trial is made: as the variable says, which is for long runs by hand; else a few times.
inline int trials(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::atoi(text) : otherwise;
}

/// All folders of this process's tests are watched.
inline std::string folders_of_tests() {
  return (fs::temp_directory_path() / ("homolog-test-" + std::to_string(::getpid()) + "-")).string();
}
struct WatchedDisk {
  WatchedDisk() { disk_watch(folders_of_tests().c_str()); }
  ~WatchedDisk() { disk_watch(nullptr); }
};

/// All that a person would miss of a case: its meshes, landmarks, regions and settings, as bytes.
inline std::string state_of(const Document& document) {
  std::string state;
  const auto add = [&state](const void* bytes, std::size_t count) {
    state.append(static_cast<const char*>(bytes), count);
  };
  const Structure* structure = document.structure();
  if (structure == nullptr) return {};
  for (const auto& [frame, shared] : structure->shapes) {
    const Shape& shape = *shared;
    // Only looked at: the template as it was placed.
    if (shape.strokes == 0 && shape.landmarks.empty() && !shape.carried) continue;
    add(&frame, sizeof frame);
    add(shape.points->data(), sizeof(double) * static_cast<std::size_t>(shape.points->size()));
    for (const auto& [name, at] : shape.landmarks) {
      state += name;
      add(at.data(), sizeof(double) * 3);
    }
  }
  add(&structure->paint.base, sizeof structure->paint.base);
  add(&document.scheme, sizeof document.scheme);
  for (const auto& region : structure->paint.regions->list) state += region.name;
  return std::to_string(std::hash<std::string>()(state));
}

/// The states of a case file: as it opens, after one undo, and after one redo. What was under way when the program
/// ended is one step at most. Fails the test where the case does not open.
inline std::vector<std::string> states_of_file(const fs::path& file) {
  auto read = read_case(file);
  REQUIRE_MESSAGE(read, (read ? std::string() : read.error().sentence()));
  EditSession& session = read->session;
  std::vector<std::string> states{state_of(session.document())};
  if (session.apply(Undo{})) {
    states.push_back(state_of(session.document()));
    REQUIRE(session.apply(Redo{}));
  }
  if (session.apply(Redo{})) states.push_back(state_of(session.document()));
  return states;
}

/// Files to work with: a small cine with a beating ball, its template, a label map, three balls and their study.
struct BallDesk {
  TemporaryFolder folder;
  fs::path image = folder.path / "cine.nii.gz", ball = folder.path / "ball.ply",
           labels = folder.path / "scans/label.nii.gz", scan = folder.path / "scans/scan.nii.gz",
           study = folder.path / "balls.study.json", torn = folder.path / "torn.homolog", out = folder.path / "out";

  BallDesk() {
    fs::create_directory(out);
    fs::create_directory(folder.path / "scans");
    const Mesh mesh = icosphere(2, BeatingBall::radius_mm(0));
    MeshFile file{mesh.points, mesh.topology->triangles()};
    file.landmarks = {{"north", Vec3(mesh.points.row(0))}, {"south", Vec3(mesh.points.row(3))}};
    REQUIRE(write_mesh_file(file, ball));
    REQUIRE(write_volume(*cine(), image));
    const Volume map = label_map(mesh, cine()->geometry, 1);
    REQUIRE(write_volume(map, labels));
    Volume first = *cine();
    auto& voxels = std::get<std::vector<float>>(first.data);
    voxels.resize(voxels.size() / BeatingBall::frames);
    first.frames = 1;
    REQUIRE(write_volume(first, scan));
    Study balls;
    for (const double stretch : {1.0, 1.1, 1.25, 1.3}) {
      Mesh shape = mesh;
      shape.points.col(2) *= stretch;
      StudyCase one_case;
      one_case.name = "ball" + std::to_string(static_cast<int>(100 * stretch));
      one_case.file = folder.path / (one_case.name + ".ply");
      MeshFile with_landmark{shape.points, shape.topology->triangles()};
      with_landmark.landmarks = {{"north", Vec3(shape.points.row(0))}};
      REQUIRE(write_mesh_file(with_landmark, one_case.file));
      balls.cases.push_back(one_case);
    }
    REQUIRE(write_study(balls, study));
    auto session = test::must(create_case(document(), torn));
    REQUIRE(session.apply(pull(1)));
    std::ofstream(torn, std::ios::app) << "{\"tool\":\"pu";
  }
  static std::shared_ptr<const Volume> cine() {
    static const auto volume = std::make_shared<const Volume>(BeatingBall::cine());
    return volume;
  }
  Document document() const {
    return new_document(image.string(), cine(), test::must(load_template(ball.string())), Similarity{});
  }
  /// A pull somewhere on the ball, another one for every number.
  static Stroke pull(int number) {
    const Vec3 at =
        BeatingBall::radius_mm(0) * Vec3(std::cos(number), std::sin(number), 0.3 * std::sin(3 * number)).normalized();
    return {Tool::pull, at, 1.1 * at, 8, {}, false, 1};
  }
  static Stroke relax(int number) {
    Stroke stroke = pull(number);
    stroke.tool = Tool::relax;
    stroke.to = stroke.at;
    return stroke;
  }
};

inline void apply(Driver& driver, Action action, bool joined = false) {
  driver.app().send(ApplyEdit{std::move(action), joined});
}

/// As settle(), and until what is written together has gone to the disk.
inline void rest(Driver& driver) {
  driver.settle();
  ::usleep(150'000);
  driver.settle();
}

}  // namespace homolog

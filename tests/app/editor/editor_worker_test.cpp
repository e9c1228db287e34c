#include "app/editor/work/worker.h"

#include <doctest/doctest.h>

#include <atomic>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "app/editor/state/figures/quality.h"
#include "app/editor/state/models/models_state.h"
#include "app/editor/work/models/build_study_model.h"
#include "app/editor/work/models/model_help.h"
#include "app/editor/work/models/study_optimiser.h"
#include "app/editor/work/opening/opener.h"
#include "app/editor/work/opening/sort_files.h"
#include "app/editor/work/shape_monitor.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/session/case_file.h"
#include "core/volume/dicom/write_dicom_segmentation.h"
#include "core/volume/volume_io.h"
#include "tests/ball.h"
#include "tests/core/volume/dicom_slices.h"
#include "tests/must.h"
#include "tests/temporary_folder.h"
#include "tests/wait.h"

// What runs beside the window.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// Work that ends when it is told to.
Result<int> until_cancelled(Progress& progress) {
  progress.report(0.5);
  REQUIRE(test::wait_until([&] { return progress.cancelled(); }));
  return 1;
}

}  // namespace

TEST_CASE("of several pieces of work the latest gives the result") {
  std::atomic<int> woken = 0;
  Worker<int> worker([&] { ++woken; });
  worker.start("first", until_cancelled);
  worker.start("second", [](Progress&) { return 2; });
  worker.finish();
  CHECK(test::must(worker.take().value()) == 2);
  CHECK_FALSE(worker.take());
  CHECK_FALSE(worker.busy());
  CHECK(test::wait_until([&] { return woken == 1; }));
}

TEST_CASE("work that is queued is done in order and what runs can be ended alone") {
  Worker<int> worker([] {});
  worker.queue("first", until_cancelled);
  for (const int k : {2, 3})
    worker.queue(
        "later", [k](Progress& progress) { return progress.cancelled() ? 0 : k; }, "Counting");
  REQUIRE(test::wait_until([&] { return worker.fraction() > 0; }));
  REQUIRE(worker.running());
  CHECK(worker.running()->subject == "first");
  CHECK(worker.running()->fraction == 0.5);
  CHECK(worker.running()->verb == std::string());
  worker.cancel_running("later");  // waits still
  CHECK_FALSE(worker.take());
  worker.cancel_running("first");
  worker.finish();
  for (const int k : {1, 2, 3}) CHECK(test::must(worker.take().value()) == k);
  CHECK_FALSE(worker.take());
}

TEST_CASE("work that is given up leaves no result") {
  Worker<int> worker([] {});
  worker.queue("done", [](Progress&) { return 1; });
  worker.finish();
  worker.queue("runs", until_cancelled);
  worker.queue("waits", [](Progress&) { return 3; });
  worker.cancel();
  CHECK_FALSE(worker.busy());
  CHECK_FALSE(worker.running());
  CHECK_FALSE(worker.take());
  worker.queue("next", [](Progress&) { return 4; });
  worker.finish();
  CHECK(test::must(worker.take().value()) == 4);
  worker.queue("runs at the end", until_cancelled);  // and does not hold the end up
}

TEST_CASE("whatever work throws is a sentence and the next work is done") {
  Worker<int> worker([] {});
  const auto sentence = [&](const std::string& subject, Worker<int>::Work work) {
    worker.queue(subject, std::move(work));
    worker.finish();
    return worker.take().value().error().sentence();
  };
  CHECK(sentence("", [](Progress&) -> Result<int> { throw std::bad_alloc(); }) ==
        "This needs more memory than there is; close other programs.");
  CHECK(sentence("a.nii", [](Progress&) -> Result<int> { throw std::length_error("vector"); }) ==
        "a.nii: needs more memory than there is; close other programs");
  CHECK(sentence("a.nii", [](Progress&) -> Result<int> {
          throw fs::filesystem_error("cannot copy", "/gone",
                                     std::make_error_code(std::errc::no_such_file_or_directory));
        }) == "/gone: No such file or directory; check that it is there and may be used");
  CHECK(sentence("a.nii", [](Progress&) -> Result<int> { throw std::runtime_error("odd"); }) ==
        "a.nii: ended in an unexpected fault (odd); please report it");
  CHECK(sentence("a.nii", [](Progress&) -> Result<int> { throw 7; }) ==
        "a.nii: ended in an unexpected fault; please report it");
  worker.queue("", [](Progress&) { return 5; });
  worker.finish();
  CHECK(test::must(worker.take().value()) == 5);
}

TEST_CASE("the quality monitor measures the mesh posted last and forgets when there is none") {
  std::atomic<int> woken = 0;
  ShapeMonitor<QualityFigures> monitor([&] { ++woken; }, "The mesh's figures", quality_of);
  CHECK_FALSE(monitor.latest());
  const auto volume = [&] { return monitor.latest()->volume_ml; };
  // As a drag posts them.
  for (int radius_mm = 20; radius_mm <= 40; ++radius_mm) {
    monitor.post(std::make_shared<const Document>(ball_document(radius_mm)));
    monitor.update();
  }
  REQUIRE(test::wait_until([&] {
    monitor.update();
    return monitor.latest() && volume() > 260;
  }));
  CHECK(woken > 0);
  CHECK_FALSE(monitor.rest_seconds());
  CHECK(monitor.error().empty());
  monitor.post(std::make_shared<const Document>(ball_document(20)));
  monitor.post(std::make_shared<const Document>(ball_document(10)));
  CHECK(monitor.rest_seconds());
  monitor.finish();
  CHECK(volume() < 5);
  monitor.post(nullptr);
  CHECK_FALSE(monitor.latest());
}

TEST_CASE("a mesh that cannot be measured ends in a sentence and the next is measured") {
  std::atomic<int> measured = 0;
  ShapeMonitor<QualityFigures> monitor([] {}, "The mesh's figures",
                                       [&](const Document& shown, const std::string& of) {
                                         if (++measured == 1) throw std::bad_alloc();
                                         return quality_of(shown, of);
                                       });
  monitor.post(std::make_shared<const Document>(ball_document(20)));
  monitor.finish();
  CHECK_FALSE(monitor.latest());
  CHECK(monitor.error() == "The mesh's figures: needs more memory than there is; close other programs");
  monitor.post(std::make_shared<const Document>(ball_document(20)));
  monitor.finish();
  CHECK(monitor.latest());
  CHECK(monitor.error().empty());
}

TEST_CASE("the opener reads what is asked for last and says why it cannot") {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "ball.ply";
  REQUIRE(write_mesh(icosphere(3, 20), file));
  std::atomic<int> woken = 0;
  Opener opener([&] { ++woken; });
  const auto opened = [&](const std::string& source) {
    OpenRequest request;
    request.template_source = source;
    opener.start(std::move(request));
    CHECK((!opener.running() || opener.running()->subject == fs::path(source).filename()));
    opener.finish();
    return opener.take().value();
  };
  const auto read = opened(file.string());
  REQUIRE(read);
  CHECK(read->the_template->points.rows() == icosphere(3).points.rows());
  CHECK_FALSE(opener.take());
  const auto absent = opened((folder.path / "absent.ply").string());
  REQUIRE_FALSE(absent);
  CHECK(absent.error().sentence().find("absent.ply") != std::string::npos);

  for (const char* name : {"absent.ply", "ball.ply"}) {
    OpenRequest request;
    request.template_source = (folder.path / name).string();
    opener.start(std::move(request));
  }
  opener.finish();
  REQUIRE(opener.take().value());
  OpenRequest given_up;
  given_up.template_source = file.string();
  opener.start(std::move(given_up));
  opener.cancel();
  CHECK_FALSE(opener.busy());
  CHECK_FALSE(opener.take());
  CHECK(test::wait_until([&] { return woken >= 3; }));
}

namespace {

/// Voxels of 1 mm, of which the first holds `first` and all others 0.
template <class Value>
Volume voxels(Value first, double origin_mm = 0) {
  Volume volume;
  volume.geometry.dims = {4, 4, 4};
  volume.geometry.origin_mm.setConstant(origin_mm);
  std::vector<Value> values(volume.geometry.voxels());
  values.front() = first;
  volume.data = values;
  return volume;
}

}  // namespace

TEST_CASE("of an image and its label map each is known in either order") {
  const TemporaryFolder folder;
  const fs::path ct = folder.path / "ct.nii", labels = folder.path / "labels.nii", real = folder.path / "real.nii",
                 other_ct = folder.path / "other.nii", away = folder.path / "away.nii";
  REQUIRE(write_volume(voxels<std::int16_t>(1000), ct));
  REQUIRE(write_volume(voxels<std::int16_t>(900), other_ct));
  REQUIRE(write_volume(voxels<std::uint8_t>(3), labels));
  REQUIRE(write_volume(voxels<float>(2), real));
  REQUIRE(write_volume(voxels<std::uint8_t>(3, 50), away));
  Opener opener([] {});
  const auto opened = [&](const std::vector<fs::path>& files) {
    opener.start(test::must(sort_files(files)));
    opener.finish();
    return opener.take().value();
  };
  for (const auto& [map, label] : {std::pair(labels, 3), std::pair(real, 2)})
    for (const auto& files : {std::vector{ct, map}, std::vector{map, ct}}) {
      const Opened both = test::must(opened(files));
      REQUIRE(both.volume);
      REQUIRE(both.labels.size() == 1);
      CHECK(both.volume->at(0, 0, 0) == 1000);
      CHECK(both.request.volume_source == ct.string());
      CHECK(both.request.labels == map);
      CHECK(both.labels.front().values == std::vector{label});
    }
  const auto refusal = [&](const std::vector<fs::path>& files) { return opened(files).error().sentence(); };
  const std::string remedy = "a label map by Template → Open a label map…";
  for (const auto& [second, why] : {std::pair(other_ct, "not a label map with the voxels of ct.nii"),
                                    std::pair(away, "not a label map with the voxels of ct.nii")}) {
    CHECK(refusal({ct, second}).starts_with(second.string() + ": is a second image, and " + why));
    CHECK(refusal({ct, second}).find(remedy) != std::string::npos);
  }
  CHECK(refusal({labels, real}).find("whether it or labels.nii is the label map") != std::string::npos);
  for (const auto& files :
       {std::vector<fs::path>{ct, labels, other_ct}, std::vector<fs::path>{"a.homolog", ct, labels}})
    CHECK(sort_files(files).error().sentence().find(remedy) != std::string::npos);
}

TEST_CASE("a segmentation that leaves empty slices out lies on the slices of the image it is opened with") {
  const TemporaryFolder folder;
  const fs::path ct = folder.path / "ct", seg = folder.path / "seg.dcm";
  Slice slice;
  slice.put(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2");
  slice.put(0x0020000d, "UI", "1.2.1");
  slice.put(0x00200052, "UI", "1.2.9");
  fs::create_directory(ct);
  for (int k = 0; k < 6; ++k) {
    slice.z = 2.5 * k;
    slice.put(0x00080018, "UI", "1.2.3." + std::to_string(k));
    slice.pixels.assign(6, 7);  // flat as a label map
    write_bytes(ct / (std::to_string(k) + ".dcm"), slice.bytes());
  }
  VolumeRead map;
  map.volume.geometry = test::must(read_volume(ct)).volume.geometry;
  std::vector<std::uint8_t> labels(map.volume.geometry.voxels());
  for (const std::size_t slice_of : {1U, 3U}) labels[6 * slice_of + 2] = 1;
  map.volume.data = labels;
  map.volume.range_max = 1;
  REQUIRE(write_dicom_segmentation(map, seg, ct));
  CHECK(test::must(read_volume(seg)).volume.geometry.dims == std::array{3, 2, 3});
  Opener opener([] {});
  const auto opened = [&](const OpenRequest& request, std::shared_ptr<const Volume> on_screen) {
    opener.start(request, std::move(on_screen));
    opener.finish();
    return test::must(opener.take().value());
  };
  for (const auto& files : {std::vector{ct, seg}, std::vector{seg, ct}}) {
    const Opened both = opened(test::must(sort_files(files)), nullptr);
    REQUIRE(both.labels.size() == 1);
    CHECK(both.request.labels == seg);
    CHECK(both.labels.front().volume->geometry == both.volume->geometry);
    CHECK(std::get<std::vector<std::uint8_t>>(both.labels.front().volume->data) == labels);
  }
  const auto image = std::make_shared<const Volume>(test::must(read_volume(ct)).volume);
  OpenRequest beside = test::must(sort_files({seg}));  // dropped on the image
  beside.beside = image;
  CHECK(opened(beside, image).labels.front().volume->geometry == image->geometry);
  OpenRequest chosen;
  chosen.labels = seg;
  CHECK(opened(chosen, image).labels.front().volume->geometry == image->geometry);
}

TEST_CASE("labels that were drawn on another scan are refused beside the image and warned of where images differ") {
  const TemporaryFolder folder;
  /// A series of another name, in another space.
  const auto series = [&](const std::string& name, const std::string& uid, const std::string& space) {
    Slice slice;
    slice.series = uid;
    slice.put(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2");
    slice.put(0x0020000d, "UI", "1.2.1");
    slice.put(0x00200052, "UI", space);
    fs::create_directory(folder.path / name);
    for (int k = 0; k < 4; ++k) {
      slice.z = 2.5 * k;
      slice.put(0x00080018, "UI", uid + "." + std::to_string(k));
      write_bytes(folder.path / name / (std::to_string(k) + ".dcm"), slice.bytes());
    }
    return folder.path / name;
  };
  const fs::path ct = series("ct", "1.2.3", "1.2.9"), same_space = series("same", "1.2.4", "1.2.9"),
                 elsewhere = series("elsewhere", "1.2.5", "1.2.10");
  VolumeRead map;
  map.volume.geometry = test::must(read_volume(ct)).volume.geometry;
  std::vector<std::uint8_t> labels(map.volume.geometry.voxels());
  labels[8] = 1;
  map.volume.data = labels;
  map.volume.range_max = 1;
  const fs::path seg = folder.path / "seg.dcm";
  REQUIRE(write_dicom_segmentation(map, seg, ct));
  Opener opener([] {});
  const auto warnings_of = [](const Result<Opened>& opened) -> Result<std::vector<std::string>> {
    if (!opened) return fail(opened.error());
    return opened->warnings;
  };
  const auto beside = [&](const fs::path& image) {
    opener.start(test::must(sort_files({image, seg})));
    opener.finish();
    auto pair = warnings_of(opener.take().value());
    const auto on_screen = std::make_shared<const Volume>(test::must(read_volume(image)).volume);
    OpenRequest chosen;
    chosen.labels = seg;
    opener.start(chosen, on_screen);
    opener.finish();
    return std::pair{std::move(pair), warnings_of(opener.take().value())};
  };
  const auto warns = [](const std::vector<std::string>& warnings) {
    return std::ranges::any_of(warnings, [](const std::string& text) {
      return text.find("refers to the series 1.2.3, and ") != std::string::npos;
    });
  };
  const auto [own, own_chosen] = beside(ct);
  CHECK_FALSE(warns(test::must(own)));
  CHECK_FALSE(warns(test::must(own_chosen)));
  const auto [same, same_chosen] = beside(same_space);
  CHECK(warns(test::must(same)));
  CHECK(warns(test::must(same_chosen)));
  const auto [other, other_chosen] = beside(elsewhere);
  for (const auto* refused : {&other, &other_chosen}) {
    REQUIRE_FALSE(*refused);
    CHECK((*refused).error().sentence().starts_with(seg.string() + ": was drawn on another scan than "));
  }
}

TEST_CASE("a case whose label map was moved away opens without it and says so") {
  const TemporaryFolder folder;
  const fs::path ball = folder.path / "ball.ply", file = folder.path / "a.homolog";
  REQUIRE(write_mesh(icosphere(3, 20), ball));
  REQUIRE(create_case(new_document("", nullptr, test::must(load_template(ball.string()))), file));
  OpenRequest request = test::must(sort_files({file}));
  request.labels = folder.path / "gone.nii.gz";
  Opener opener([] {});
  opener.start(std::move(request));
  opener.finish();
  const auto opened = opener.take().value();
  REQUIRE(opened);
  CHECK(opened->opened_case);
  CHECK(opened->labels.empty());
  CHECK(std::ranges::any_of(opened->warnings,
                            [](const std::string& text) { return text.find("gone.nii.gz") != std::string::npos; }));
}

TEST_CASE("files are sorted and named where the working folder is gone") {
  const fs::path before = fs::current_path();
  {
    const TemporaryFolder folder;
    fs::current_path(folder.path);
  }
  const auto request = sort_files({"some.homolog"});
  ModelsState state;
  CHECK(add_cases(state, {"some.ply"}) == 1);
  set_study_template(state, "some.ply");
  fs::current_path(before);
  CHECK(test::must(request).case_file == "some.homolog");
  CHECK(state.study.template_file == "some.ply");
}

TEST_CASE("the rounds of an optimisation come before its result and one that was given up leaves none") {
  auto study = std::make_shared<StudyToOptimise>();
  TrainingSet set;
  set.topology = icosphere(2, 20).topology;
  set.shapes.resize(3 * set.topology->vertices(), 4);
  for (int k = 0; k < 4; ++k) {
    Points points = icosphere(2, 20).points;
    points.col(0) *= 1 + 0.1 * k;
    points.col(2) += 0.004 * k * k * points.col(0).cwiseAbs2();
    set.names.push_back(std::to_string(k));
    set.shapes.col(k) = points.reshaped<Eigen::RowMajor>();
    study->fitted.shapes[set.names.back()] =
        std::make_shared<const MeshFile>(MeshFile{points, set.topology->triangles()});
  }
  set.faced = FacedNames{"atrium", false};
  Progress progress;
  study->fitted.model = test::must(make_study_model(set, {"", "", "", ""}, Alignment::similarity, progress));
  std::atomic<int> woken = 0;
  StudyOptimiser optimiser([&] { ++woken; });
  optimiser.start(study);
  std::size_t rounds = 0;
  std::optional<Result<OptimisedStudy>> done;
  REQUIRE(test::wait_until([&] {
    if (const auto more = optimiser.take_rounds()) {
      CHECK(more->size() > rounds);
      rounds = more->size();
    }
    if (optimiser.busy()) return false;
    if (const auto last = optimiser.take_rounds()) rounds = last->size();
    done = optimiser.take();
    return true;
  }));
  REQUIRE(done);
  const OptimisedStudy optimised = test::must(std::move(*done));
  CHECK(rounds == 21);
  CHECK(woken >= 21);
  CHECK(optimised.after.bits < optimised.before.bits);
  CHECK(optimised.shapes.shapes.size() == 4);
  CHECK(optimised.shapes.sizes.size() == 4);
  CHECK(optimised.shapes.model->names == set.names);
  CHECK(optimised.shapes.model->model.faced == set.faced);
  CHECK(test::must(model_of_others(*study->fitted.model, 0)).faced == set.faced);

  optimiser.start(study);
  optimiser.cancel();
  CHECK_FALSE(optimiser.busy());
  CHECK_FALSE(optimiser.take());
}

}  // namespace homolog

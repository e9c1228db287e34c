#include <filesystem>

#include "app/pictures/pictures.h"
#include "app/verbs/verb.h"
#include "core/base/files/files.h"
#include "core/base/pictures/picture_io.h"
#include "core/experiment/demo_case.h"
#include "core/experiment/scripted_user.h"
#include "core/measure/compare.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/files/statismo.h"
#include "core/model/measures/leave_one_out.h"
#include "core/session/case_file.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr int demo_subject = 1;

/// The whole job without a display: template, placement by landmarks, strokes, mesh, label map, pictures.
class HeadlessDemo {
 public:
  HeadlessDemo(fs::path folder, Progress& progress) : folder_(std::move(folder)), progress_(progress) {}

  Result<Report> play() {
    const auto made = ResultFolder::make(folder_);
    if (!made) return fail(made.error());
    std::error_code error;
    auto report = play_all();
    // Nothing half-done is left; what was there before is whole, in its old or its new form.
    if (!report)
      for (const fs::path& file : new_) fs::remove(file, error);
    return report;
  }

 private:
  Result<Report> play_all() {
    auto document = demo_document(Organ::kidney, demo_subject);
    if (!document) return fail(document.error());
    EditSession session(std::move(*document));
    const Volume truth = make_phantom(Organ::kidney, demo_subject).label_map;
    for (const auto step : {&HeadlessDemo::adapt, &HeadlessDemo::export_mesh, &HeadlessDemo::export_pictures,
                            &HeadlessDemo::export_model}) {
      if (auto done = (this->*step)(session, truth); !done) return fail(done.error());
    }
    // Last, so that there is no case where the disk could not hold the rest.
    if (auto saved = save_case_as(session, written("demo.homolog")); !saved) return fail(saved.error());
    report_.values["paths"] = paths_;
    return report_;
  }

  fs::path written(const char* name) {
    const fs::path path = folder_ / name;
    paths_.push_back(path.string());
    std::error_code ignored;
    if (!fs::exists(path, ignored)) new_.push_back(path);
    return path;
  }

  Result<void> adapt(EditSession& session, const Volume& truth) {
    const auto before = compare_with_mask(session.document().view()->mesh(), truth, 1);
    const auto target = mask_surface(truth, 1);
    if (!before || !target) return fail(before ? target.error() : before.error());
    PullingOptions options;
    options.most_pulls = 30;
    options.progress = &progress_;
    const auto pulled = pull_to_target(session, *target, options);
    if (!pulled) return fail(pulled.error());
    const auto after = compare_with_mask(session.document().view()->mesh(), truth, 1);
    if (!after) return fail(after.error());
    report_.values["placed"] = {{"assd_mm", before->assd_mm}, {"dice", before->dice}};
    report_.values["pulled"] = {{"pulls", pulled->pulls}, {"assd_mm", after->assd_mm}, {"dice", after->dice}};
    return {};
  }

  Result<void> export_mesh(EditSession& session, const Volume& truth) {
    const ShapeView shown = *session.document().view();
    if (auto done = write_mesh_file(to_mesh_file(shown.the_template()), written("template.ply")); !done) return done;
    if (auto done = write_mesh_file(to_mesh_file(shown, false), written("kidney.ply")); !done) return done;
    const Volume labels = label_map(shown.mesh(), truth.geometry);
    report_.values["volume_ml"] = static_cast<double>(labels_of(labels)[1]) * truth.geometry.voxel_volume_mm3() / 1000;
    return write_volume(labels, written("kidney.nii.gz"));
  }

  Result<void> export_pictures(EditSession& session, const Volume&) {
    MontageOptions options;
    auto picture = case_picture(session.document(), options);
    if (!picture) return fail(picture.error());
    if (auto done = write_picture(picture->picture, written("case.png")); !done) return done;
    options.height_px = options.width_px / 2;
    const ShapeView shown = *session.document().view();
    const Mesh before{shown.the_template().topology, *shown.shape.placed};
    picture = correspondence_picture({before, shown.mesh()}, {"before", "after"}, options);
    if (!picture) return fail(picture.error());
    return write_picture(picture->picture, written("correspondence.png"));
  }

  /// The adapted mesh and other phantom subjects as a shape model: they share the template's vertices.
  Result<void> export_model(EditSession& session, const Volume&) {
    constexpr int others = 9;
    const Points& adapted = *session.document().view()->shape.points;
    ShapeMatrix shapes(adapted.size(), others + 1);
    std::vector<std::string> names{"demo"};
    shapes.col(0) = adapted.reshaped<Eigen::RowMajor>();
    for (int k = 1; k <= others; ++k) {
      shapes.col(k) = phantom_truth(Organ::kidney, demo_subject + k).front().points.reshaped<Eigen::RowMajor>();
      names.push_back("phantom " + std::to_string(demo_subject + k));
    }
    align(shapes, Alignment::similarity);
    const auto components = principal_components(std::move(shapes));
    ShapeModel model = make_model(components, 0.95, session.document().structure()->the_template->topology, names);
    model.left_out_distances = left_out_distances(components, model.modes());
    if (auto done = write_model(model, written("model.h5.json")); !done) return done;
    report_.values["model"] = {{"shapes", others + 1}, {"modes", model.modes()}};
    const auto picture = modes_picture(model, 2, {});
    if (!picture) return fail(picture.error());
    return write_picture(picture->picture, written("modes.png"));
  }

  fs::path folder_;
  Progress& progress_;
  std::vector<std::string> paths_;
  std::vector<fs::path> new_;  ///< those of them that were not there before
  Report report_;
};

bool has_display() {
  return std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
}

}  // namespace

void add_demo(CLI::App& app, CommandLine& asked) {
  struct Options {
    bool headless = false;
    fs::path folder = "homolog-demo";
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, "demo", "The built-in phantom case in the editor, ready to drag");
  verb->add_flag("--headless", options->headless, "Without a window: plays the whole job and writes its files");
  verb->add_option("-o,--output", options->folder, "Folder for the files of --headless");
  verb->callback([options, &asked] {
    if (options->headless || !has_display()) {
      asked.run = [options](Progress& progress) { return HeadlessDemo(options->folder, progress).play(); };
    } else {
      asked.editor.demo = Organ::kidney;
    }
  });
}

}  // namespace homolog

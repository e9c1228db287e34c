#include <optional>
#include <sstream>

#include "app/verbs/input_folders.h"
#include "app/verbs/model/score_shapes.h"
#include "app/verbs/read_image.h"
#include "app/verbs/record.h"
#include "app/verbs/verbs.h"
#include "core/base/files/files.h"
#include "core/base/text/listed.h"
#include "core/mesh/formats/formats.h"
#include "core/model/files/model_files.h"
#include "core/model/files/statismo.h"
#include "core/model/measures/score.h"
#include "core/model/training_set.h"

// The verb `score`: subjects against a model that stays as it is.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct ScoreJob {
  NewShapes shapes;
  fs::path out;
  GivenCommand command;
};

Json described_part(const ScoreOfPart& part) {
  return {{"z_rms", part.z_rms}, {"residual_mm", part.residual_mm}};
}

Json described_score(const std::string& name, const ShapeScore& score, const ShapeModel& model, const NewShape& shape) {
  Json row{{"name", name},
           {"distance", score.distance},
           {"residual_mm", score.residual_mm},
           {"percentile", score.percentile ? Json(*score.percentile) : Json()},
           {"z_rms", score.all.z_rms},
           {"size_mm", score.size_mm},
           {"modes", std::vector<double>(score.modes.begin(), score.modes.end())},
           {"doubt", shape.doubt.empty() ? Json() : Json(shape.doubt)}};
  if (shape.beyond_share > 0) row["beyond_share"] = shape.beyond_share;
  if (model.parts.empty()) return row;
  Json parts = Json::array();
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    Json part = described_part(score.parts[k]);
    part["name"] = model.parts[k].name;
    parts.push_back(std::move(part));
  }
  row["structures"] = std::move(parts);
  return row;
}

/// What is said of a subject that the model was made of.
std::string own_shape(const ShapeModel& model, Eigen::Index trained) {
  const auto k = static_cast<std::size_t>(trained);
  return ": is itself a shape of the model" +
         (k < model.names.size() && !model.names[k].empty() ? " (" + model.names[k] + ")" : std::string()) +
         ", so that it seems nearer to the mean than it is; score it against a model of the others";
}

/// Writes a shape with z of each vertex, where it lies: as VTP, since in PLY z is a coordinate.
Result<void> write_scored(const MeshFile& shape, const ShapeModel& model, const ShapeScore& score, std::string record,
                          const fs::path& to) {
  const MeshFile file{.points = shape.points,
                      .triangles = model.topology,
                      .doubt_mm = shape.doubt_mm,
                      .values = {{"z", score.z}, {"z_low", score.z_low}, {"z_high", score.z_high}},
                      .record = std::move(record)};
  return write_mesh_file(file, to);
}

Result<void> write_score_table(const Json& subjects, const fs::path& path) {
  std::ostringstream table;
  table.precision(9);
  table << "name,distance,residual_mm,percentile,z_rms,size_mm";
  for (std::size_t m = 0; m < subjects[0]["modes"].size(); ++m) table << ",mode_" << m + 1;
  table << '\n';
  for (const Json& one : subjects) {
    table << csv_field(one["name"].get<std::string>());
    for (const char* column : {"distance", "residual_mm", "percentile", "z_rms", "size_mm"}) {
      table << ',';
      if (!one[column].is_null()) table << one[column].get<double>();
    }
    for (const Json& mode : one["modes"]) table << ',' << mode.get<double>();
    table << '\n';
  }
  return write_whole_file(path, table.str());
}

Result<Report> score(const ScoreJob& job, Progress& progress) {
  if (auto there = check_there({job.shapes.landmarks}); !there) return fail(there.error());
  const NewShapes asked = with_maps_opened(job.shapes);
  const auto model = read_model(asked.model);
  if (!model) return fail(model.error());
  Report report;
  progress.part(0, 0.9);
  auto shapes = read_new_shapes(asked, *model, report.warnings, progress);
  if (!shapes) return fail(shapes.error());
  progress.part(0.9, 1);
  std::vector<std::string> files;
  for (const NewShape& shape : *shapes) files.push_back(shape.name);
  const auto names = shape_names(files);          // of files
  const auto called = names_with_folders(files);  // in tables, as `test` and `measure` name them
  std::vector<fs::path> to_write;
  for (const std::string& name : names) to_write.push_back(job.out / (name + ".vtp"));
  if (!job.out.empty())
    if (auto safe = check_not_read(to_write, {files.begin(), files.end()}); !safe) return fail(safe.error());
  std::optional<ResultFolder> folder;
  if (!job.out.empty()) {
    auto made = ResultFolder::make(job.out);
    if (!made) return fail(made.error());
    folder.emplace(std::move(*made));
  }
  Json subjects = Json::array();
  std::vector<std::string> of_files(asked.files.size());  // records, each of what one file gives
  for (std::size_t k = 0; k < shapes->size(); ++k) {
    const MeshFile& mesh = (*shapes)[k].mesh;
    const auto scored = score_shape(*model, mesh.points, mesh.doubt_mm ? *mesh.doubt_mm : VertexScalars());
    if (!scored) {
      report.warnings.push_back(files[k] + ": " + scored.error().what);
      continue;
    }
    subjects.push_back(described_score(called[k], *scored, *model, (*shapes)[k]));
    if (scored->trained) report.warnings.push_back(files[k] + own_shape(*model, *scored->trained));
    if (job.out.empty()) continue;
    auto record = of_files[(*shapes)[k].from];
    if (record.empty()) {
      auto made = record_of(job.command.with("NEW", {asked.files[(*shapes)[k].from]}), progress);
      if (!made) return fail(made.error());
      of_files[(*shapes)[k].from] = record = std::move(*made);
    }
    const std::string file = names[k] + ".vtp";
    if (auto written = write_scored(mesh, *model, *scored, record_of_output(record, file), job.out / file); !written)
      return fail(written.error());
  }
  if (subjects.empty())
    return fail(asked.files.front().string(),
                report.warnings.empty() ? "holds no shape"
                                        : "gives no shape to score; the first reason: " + report.warnings.front());
  if (!job.out.empty())
    if (auto written = write_score_table(subjects, job.out / "scores.csv"); !written) return fail(written.error());
  if (!job.out.empty()) report.made = {job.out / "scores.csv"};
  const auto& others = model->left_out_distances;
  report.values = {{"subjects", std::move(subjects)},
                   {"training_distances", std::vector<double>(others.begin(), others.end())}};
  return report;
}

}  // namespace

void add_score(CLI::App& app, CommandLine& asked) {
  auto job = std::make_shared<ScoreJob>();
  CLI::App* verb = add_verb(app, "score", "How far subjects are from a model, which stays as it is");
  verb->add_option(
          "NEW", job->shapes.files,
          "Meshes in the model's numbering, cases, studies, label maps to which the model's mean is fitted, or images "
          "with --landmarks; for a joint model folders of cases, cases or studies. What a study flips is flipped")
      ->required();
  verb->add_option("--model", job->shapes.model, "The model (.h5, .h5.json)")->required();
  add_label_option(*verb, job->shapes.label, "Which label of a map");
  add_mask_frame_option(*verb, job->shapes.frame);
  auto* landmarks = verb->add_option("--landmarks", job->shapes.landmarks,
                                     "NEW are images: the landmarks that were placed in one, or a folder with a file "
                                     "of each one's name; the mean starts there and is drawn to the boundary")
                        ->excludes("--label");
  auto* the_template = verb->add_option("--template", job->shapes.the_template,
                                        "The model's template, which says where the landmarks lie on it")
                           ->needs(landmarks);
  landmarks->needs(the_template);
  verb->add_flag("--flip-mirrored", job->shapes.flip_mirrored,
                 "Flip shapes that are mirror images of the model's mean");
  verb->add_option("-o,--output", job->out,
                   "Folder for scores.csv and for each mesh (.vtp) with z, z_low and z_high of every vertex");
  verb->callback([job, verb, &asked] {
    job->command = given_command(*verb);
    asked.run = [job](Progress& progress) { return score(*job, progress); };
  });
}

}  // namespace homolog

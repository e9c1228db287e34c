#include "app/verbs/model/training.h"

#include <algorithm>
#include <cmath>

#include "core/base/text/listed.h"
#include "core/measure/meeting.h"
#include "core/mesh/formats/formats.h"
#include "core/model/joint_models/joint_alignment.h"
#include "core/model/joint_models/joint_set.h"
#include "core/model/joint_models/structure_files.h"

namespace homolog {

namespace {

Json listed_shapes(const std::vector<DoubtfulShape>& shapes) {
  Json list = Json::array();
  for (const DoubtfulShape& one : shapes) list.push_back({{"name", one.name}, {"reason", one.reason}});
  return list;
}

/// Errors: more modes are asked for than the shapes have.
Result<void> find_components(ShapeMatrix shapes, const TrainingVerb& options, Training& training) {
  const Eigen::Index most = std::min(shapes.cols() - 1, shapes.rows());
  if (options.leading_modes > most)
    return fail("--modes " + std::to_string(options.leading_modes),
                "is more than " + std::to_string(shapes.cols()) + " shapes allow; the most is " + std::to_string(most));
  training.components = options.leading_modes > 0 ? leading_components(std::move(shapes), options.leading_modes)
                                                  : principal_components(std::move(shapes));
  return {};
}

Result<Training> of_several(const TrainingVerb& options, Progress& progress, bool keep_unaligned) {
  const auto frame = options.world ? ShapeWorksFrame::world : ShapeWorksFrame::local;
  const auto cases = structure_files(options.files, options.structures, frame);
  if (!cases) return fail(cases.error());
  auto joint = read_joint_set(*cases, options.structures,
                              {options.reading.without_doubtful, options.complete, options.alignment()}, &progress);
  if (!joint) return fail(joint.error());
  Training training;
  if (keep_unaligned) training.in_scan = joint->read.set.shapes;
  training.parts = std::move(joint->parts);
  training.completed = std::move(joint->completed);
  training.names = std::move(joint->read.set.names);
  training.topology = std::move(joint->read.set.topology);
  training.warnings = std::move(joint->read.warnings);
  training.doubtful = std::move(joint->read.doubtful);
  training.left_out = std::move(joint->read.left_out);
  training.groups = std::move(joint->read.groups);
  training.study_keys = std::move(joint->read.study_keys);
  ShapeMatrix shapes = std::move(joint->read.set.shapes);
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) training.sizes_mm.push_back(centroid_size_mm(points_of(shapes, k)));
  training.poses = align_structures(shapes, training.parts, options.alignment(), options.together == "each");
  if (auto found = find_components(std::move(shapes), options, training); !found) return fail(found.error());
  if (!training.completed.empty())
    training.warnings.push_back(
        std::to_string(training.completed.size()) +
        (training.completed.size() == 1 ? " structure is" : " structures are") +
        " not the case's own but what the others let expect; it varies less than real ones do, so the model's "
        "variances are too small");
  return training;
}

Result<Training> varied(Training training) {
  if (training.components.scatter.size() == 0) {
    std::vector<Meeting> met;
    // About their diameter: the centroid size grows with the number of vertices.
    const double share = 2 / std::sqrt(std::max(1.0, static_cast<double>(training.components.vertices())));
    for (std::size_t k = 0; k < training.sizes_mm.size(); ++k)
      met.push_back({training.names[k], share * training.sizes_mm[k]});
    if (const auto misfits = misfits_among(met, "the other shapes"); !misfits.empty()) return fail("", misfits.front());
    return fail(training.names.front(),
                "differs from the other shapes by its pose alone, so there is nothing to model; give different shapes");
  }
  return training;
}

}  // namespace

void add_set_options(CLI::App& verb, TrainingVerb& options) {
  verb.add_option("SHAPE", options.files,
                  "Shapes in correspondence (" + listed(mesh_format_extensions(&MeshFormat::keeps_numbers), ", ") +
                      ", .homolog), a folder of them, or a study (.study.json)")
      ->required();
  auto* keep_scale = verb.add_flag("--keep-scale", options.keep_scale, "Align by translation and rotation only");
  verb.add_flag("--no-align", options.no_align, "Do not align the shapes")->excludes(keep_scale);
  verb.add_flag("--all-frames", options.reading.all_frames,
                "Take every edited frame of a cine, not only the one that the case shows");
  verb.add_flag("--flip-mirrored", options.reading.flip_mirrored, "Flip shapes that are mirror images of most others");
  verb.add_option("--group", options.reading.group, "Take only the cases of this group of a study");
  verb.add_flag("--without-doubtful", options.reading.without_doubtful,
                "Leave out shapes that are doubtful, mirrored (without --flip-mirrored) or have faulty faces");
}

void add_training_options(CLI::App& verb, TrainingVerb& options) {
  add_set_options(verb, options);
  auto* structures =
      verb.add_option("--structures", options.structures,
                      "Join several structures, as A,B: SHAPE is then a folder with CASE/A.ply, as fit SET writes it, "
                      "or ShapeWorks' folder with CASE_A_local.particles")
          ->delimiter(',')
          ->excludes("--all-frames")
          ->excludes("--flip-mirrored")
          ->excludes("--group");
  verb.add_option("--alignment", options.together,
                  "common: the structures of a case are aligned together, so that their relative pose is in the "
                  "model. each: each on its own, and the poses are kept apart")
      ->check(CLI::IsMember({"common", "each"}))
      ->needs(structures);
  verb.add_flag("--world", options.world, "Of ShapeWorks' folder take CASE_A_world.particles")->needs(structures);
}

void check_training_options(const TrainingVerb& options) {
  if (options.no_align && options.together == "each")
    throw CLI::ValidationError("--alignment each", "aligns each structure on its own; leave --no-align out");
}

void Training::report(Json& values) const {
  values["doubtful"] = listed_shapes(doubtful);
  values["left_out"] = listed_shapes(left_out);
  if (!poses) return;
  values["alignment"] = poses->apart ? "each" : "common";
  values["structures"] = json_of(parts, *poses);
  values["pose_variances"] = std::vector<double>(poses->variances.begin(), poses->variances.end());
  values["completed"] = json_of(completed, names, parts);
}

Json json_of(const std::vector<StructurePart>& parts, const StructurePoses& poses) {
  Json list = Json::array();
  const double free = static_cast<double>(std::max<Eigen::Index>(1, poses.values.cols() - 1));
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto rows =
        poses.values.middleRows(StructurePoses::numbers * static_cast<Eigen::Index>(k), StructurePoses::numbers);
    const Eigen::ArrayXd scales = rows.row(6).array().exp();
    list.push_back({{"name", parts[k].name},
                    {"first_vertex", parts[k].first_vertex},
                    {"vertices", parts[k].vertices},
                    {"first_face", parts[k].first_triangle},
                    {"faces", parts[k].triangles},
                    {"offset_sd_mm", std::sqrt(rows.topRows(3).squaredNorm() / free)},
                    {"turn_sd_deg", std::sqrt(rows.middleRows(3, 3).squaredNorm() / free)},
                    {"scale_sd", std::sqrt((scales - scales.mean()).square().sum() / free)}});
  }
  return list;
}

Json json_of(const std::vector<CompletedStructure>& completed, const std::vector<std::string>& names,
             const std::vector<StructurePart>& parts) {
  Json list = Json::array();
  for (const CompletedStructure& one : completed)
    list.push_back({{"name", names[one.shape]},
                    {"structure", parts[one.part].name},
                    {"expected_error_mm", one.expected_error_mm},
                    {"mean_error_mm", one.mean_error_mm}});
  return list;
}

Result<Training> train(TrainingSetRead read, const TrainingVerb& options) {
  Training training;
  training.names = std::move(read.set.names);
  training.topology = read.set.topology;
  training.faced = std::move(read.set.faced);
  training.warnings = std::move(read.warnings);
  training.groups = std::move(read.groups);
  training.study_keys = std::move(read.study_keys);
  if (options.reading.flip_mirrored) training.flipped = read.mirrored.size();
  for (Eigen::Index k = 0; k < read.set.shapes.cols(); ++k)
    training.sizes_mm.push_back(centroid_size_mm(points_of(read.set.shapes, k)));
  training.doubtful = std::move(read.doubtful);
  training.left_out = std::move(read.left_out);
  align(read.set.shapes, options.alignment());
  if (auto found = find_components(std::move(read.set.shapes), options, training); !found) return fail(found.error());
  return varied(std::move(training));
}

Result<Training> train(const TrainingVerb& options, Progress& progress, bool keep_unaligned) {
  if (!options.structures.empty()) {
    auto training = of_several(options, progress, keep_unaligned);
    return training ? varied(std::move(*training)) : training;
  }
  auto read = read_training_set(options.files, options.reading, &progress);
  if (!read) return fail(read.error());
  return train(std::move(*read), options);
}

}  // namespace homolog

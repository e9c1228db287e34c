#include "core/model/files/statismo_parts.h"

#include <array>

#include "core/model/files/statismo_values.h"

namespace homolog::statismo {

namespace {

constexpr const char* parts_group = "/homolog/structures";
constexpr const char* part_names_start = "/homolog/structures/name_";
constexpr const char* poses_group = "/homolog/poses";

template <class Rows>
HdfTree::Dataset integers_of(const Rows& rows, std::size_t columns) {
  HdfTree::Dataset dataset;
  std::vector<std::int32_t> values;
  for (const auto& row : rows)
    for (const Eigen::Index value : row) values.push_back(static_cast<std::int32_t>(value));
  dataset.dims = {values.size() / columns, columns};
  dataset.values = std::move(values);
  return dataset;
}

/// The structures one after the other, as they fill the model; none where the file's do not.
std::vector<StructurePart> parts_in(const HdfTree& tree, const ShapeModel& model) {
  const auto* ranges = tree.integers(std::string(parts_group) + "/ranges");
  if (ranges == nullptr || ranges->empty() || ranges->size() % 4 != 0) return {};
  std::vector<StructurePart> parts;
  StructurePart next;
  for (std::size_t k = 0; 4 * k < ranges->size(); ++k) {
    const std::string name = part_names_start + std::to_string(k);
    const std::int32_t* of = ranges->data() + 4 * k;
    if (!tree.datasets.contains(name) || of[0] != next.first_vertex || of[1] <= 0 || of[2] != next.first_triangle ||
        of[3] < 0)
      return {};
    parts.push_back({tree.text(name), of[0], of[1], of[2], of[3]});
    next.first_vertex += of[1];
    next.first_triangle += of[3];
  }
  const Eigen::Index triangles = model.topology ? model.topology->triangles().rows() : 0;
  if (3 * next.first_vertex != model.mean.size() || next.first_triangle != triangles) return {};
  // Each on its own is a mesh: no face goes from one structure to another.
  for (const StructurePart& part : parts)
    if (part.triangles > 0) {
      const auto own = triangles_of(part, model.topology->triangles());
      if (own.minCoeff() < 0 || own.maxCoeff() >= part.vertices) return {};
    } else if (model.topology) {
      return {};
    }
  return parts;
}

std::optional<StructurePoses> poses_in(const HdfTree& tree, Eigen::Index parts) {
  const std::string start = std::string(poses_group) + "/";
  const Eigen::Index rows = StructurePoses::numbers * parts;
  const auto values = matrix_at(tree, start + "values", rows, -1);
  const auto radius = matrix_at(tree, start + "radius", parts, 1);
  if (!values || !radius) return std::nullopt;
  StructurePoses poses;
  poses.apart = tree.attribute(poses_group, "alignment") == "each";
  poses.values = values->cast<double>();
  poses.radius_mm = radius->cast<double>();
  const auto variances = matrix_at(tree, start + "pcaVariance", -1, 1);
  if (!variances) return poses;
  const auto basis = matrix_at(tree, start + "pcaBasis", rows, variances->rows());
  if (!basis) return std::nullopt;
  poses.basis = basis->cast<double>();
  poses.variances = variances->cast<double>();
  return poses;
}

}  // namespace

void add_structures(const ShapeModel& model, HdfTree& tree) {
  if (model.parts.empty()) return;
  auto& datasets = tree.datasets;
  tree.add_group(parts_group);
  std::vector<std::array<Eigen::Index, 4>> ranges;
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    const StructurePart& part = model.parts[k];
    datasets[part_names_start + std::to_string(k)] = text_of(part.name);
    ranges.push_back({part.first_vertex, part.vertices, part.first_triangle, part.triangles});
  }
  datasets[std::string(parts_group) + "/ranges"] = integers_of(ranges, 4);
  if (!model.completed.empty()) {
    std::vector<std::array<Eigen::Index, 2>> which;
    Eigen::MatrixXd errors(std::ssize(model.completed), 2);
    for (std::size_t k = 0; k < model.completed.size(); ++k) {
      which.push_back({model.completed[k].shape, model.completed[k].part});
      errors.row(static_cast<Eigen::Index>(k)) << model.completed[k].expected_error_mm,
          model.completed[k].mean_error_mm;
    }
    datasets[std::string(parts_group) + "/completed"] = integers_of(which, 2);
    datasets[std::string(parts_group) + "/completedError"] = floats_of(errors);
  }
  if (!model.poses) return;
  const StructurePoses& poses = *model.poses;
  const std::string start = std::string(poses_group) + "/";
  tree.add_group(poses_group) = {
      {"alignment", poses.apart ? "each" : "common"},
      {"rows", "of each structure: offset x y z in mm, turn x y z in degrees, log of scale"}};
  datasets[start + "values"] = floats_of(poses.values);
  datasets[start + "radius"] = floats_of(poses.radius_mm, true);
  if (poses.variances.size() == 0) return;
  datasets[start + "pcaBasis"] = floats_of(poses.basis);
  datasets[start + "pcaVariance"] = floats_of(poses.variances, true);
}

void read_structures(const HdfTree& tree, ShapeModel& model) {
  model.parts = parts_in(tree, model);
  if (model.parts.empty()) return;
  model.poses = poses_in(tree, std::ssize(model.parts));
  const auto* which = tree.integers(std::string(parts_group) + "/completed");
  if (which == nullptr) return;
  const auto errors = matrix_at(tree, std::string(parts_group) + "/completedError", std::ssize(*which) / 2, 2);
  if (!errors) return;
  for (Eigen::Index k = 0; k < errors->rows(); ++k) {
    const auto at = static_cast<std::size_t>(2 * k);
    const CompletedStructure one{(*which)[at], (*which)[at + 1], static_cast<double>((*errors)(k, 0)),
                                 static_cast<double>((*errors)(k, 1))};
    if (one.shape >= 0 && one.shape < std::ssize(model.names) && one.part >= 0 && one.part < std::ssize(model.parts))
      model.completed.push_back(one);
  }
}

void add_structure_parts(HdfParts& parts) {
  const std::string structures = parts_group, poses = poses_group;
  parts.attributes.emplace_back(poses, "alignment");
  parts.datasets.insert(parts.datasets.end(),
                        {structures + "/ranges", structures + "/completed", structures + "/completedError",
                         poses + "/values", poses + "/radius", poses + "/pcaBasis", poses + "/pcaVariance"});
  parts.numbered.emplace_back(part_names_start);
}

}  // namespace homolog::statismo

#include "core/model/joint_models/joint_set.h"

#include <algorithm>
#include <map>

#include "core/base/text/listed.h"
#include "core/model/joint_models/complete_structures.h"
#include "core/model/shapes/shape_files.h"

namespace homolog {

namespace {

/// The shapes of one structure, by case.
struct OneStructure {
  TrainingSetRead read;
  std::map<std::string, Eigen::Index> column;  ///< the column of the shape that a file gave
  std::map<std::string, std::string> doubt;    ///< the doubt of a file that was left out
  std::map<std::string, VertexScalars> vertex_doubts;
};

Result<OneStructure> read_structure(const std::vector<CaseFiles>& cases, std::size_t structure, const std::string& name,
                                    const JointOptions& options, Progress* progress) {
  std::vector<ShapeSource> sources;
  for (const CaseFiles& one : cases)
    if (!one.of_structure[structure].file.empty()) sources.push_back(one.of_structure[structure]);
  OneStructure result;
  std::vector<DoubtfulShape> doubtful;
  TrainingSetBuilder builder(sources.size());
  const auto take = [&](const ReadShape& shape) {
    if (!shape.doubt.empty()) doubtful.push_back({shape.name, shape.doubt});
    if (options.without_doubtful && !shape.doubt.empty()) {
      result.doubt[shape.name] = shape.doubt;
      return Result<void>();
    }
    result.column[shape.name] = static_cast<Eigen::Index>(builder.shapes());
    if (options.vertex_doubts && shape.mesh->doubt_mm) result.vertex_doubts[shape.name] = *shape.mesh->doubt_mm;
    builder.add(shape.name, *shape.mesh);
    return Result<void>();
  };
  const auto warnings = read_shapes(sources, {false, true}, take, progress);
  if (!warnings) return fail(warnings.error());
  if (builder.shapes() < 2)
    return fail(too_small({name,
                           "has fewer than two shapes that can be used; a joint model needs at least two cases "
                           "with all structures, so fit more cases"},
                          *warnings));
  auto read = builder.finish();
  if (!read) return fail(too_small(read.error(), *warnings));
  result.read = std::move(*read);
  result.read.warnings.insert(result.read.warnings.begin(), warnings->begin(), warnings->end());
  for (const std::string& mirrored : result.read.mirrored)
    result.read.warnings.push_back(mirrored +
                                   ": a mirror image of those of the other cases (left and right exchanged); correct "
                                   "the case, or leave it out");
  if (!options.without_doubtful) result.read.doubtful = std::move(doubtful);
  return result;
}

/// The structures of a case, joined.
struct OneCase {
  std::string name;
  IncompleteShape shape;
  std::vector<std::string> lacks;         ///< each with the reason
  VertexScalars doubt_mm{};               ///< the doubt of all vertices; empty where a structure has none
  std::string group{};                    ///< the group of a study's case
  std::vector<std::string> study_keys{};  ///< keys of the study's cases that its structures are
};

std::vector<StructurePart> parts_of(const std::vector<std::string>& names, const std::vector<OneStructure>& of) {
  std::vector<StructurePart> parts;
  const bool faces = std::all_of(of.begin(), of.end(), [](const OneStructure& one) { return one.read.set.topology; });
  StructurePart part;
  for (std::size_t k = 0; k < names.size(); ++k) {
    part.name = names[k];
    part.vertices = of[k].read.set.shapes.rows() / 3;
    part.triangles = faces ? of[k].read.set.topology->triangles().rows() : 0;
    parts.push_back(part);
    part.first_vertex += part.vertices;
    part.first_triangle += part.triangles;
  }
  return parts;
}

Result<std::shared_ptr<const Topology>> joint_topology(const std::vector<StructurePart>& parts,
                                                       const std::vector<OneStructure>& of) {
  const StructurePart& last = parts.back();
  if (last.triangles == 0) return std::shared_ptr<const Topology>();
  Triangles triangles(last.first_triangle + last.triangles, 3);
  for (std::size_t k = 0; k < parts.size(); ++k)
    triangles.middleRows(parts[k].first_triangle, parts[k].triangles) =
        of[k].read.set.topology->triangles().array() + static_cast<std::int32_t>(parts[k].first_vertex);
  return Topology::make(last.first_vertex + last.vertices, std::move(triangles));
}

OneCase joined_case(const CaseFiles& files, const std::vector<StructurePart>& parts,
                    const std::vector<OneStructure>& of) {
  OneCase one{files.name, {}, {}};
  const Eigen::Index vertices = parts.back().first_vertex + parts.back().vertices;
  one.shape.points.setZero(3 * vertices);
  one.doubt_mm.setZero(vertices);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const ShapeSource& source = files.of_structure[k];
    if (one.group.empty()) one.group = source.group;
    if (!source.study_case.empty()) one.study_keys.push_back(source.study_key());
    const std::string file = source.file.empty() ? std::string() : source.name(source.frame);
    const auto found = of[k].column.find(file);
    one.shape.has.push_back(found != of[k].column.end());
    const auto known = of[k].vertex_doubts.find(file);
    const bool has_doubt = known != of[k].vertex_doubts.end() && known->second.size() == parts[k].vertices;
    if (!has_doubt) one.doubt_mm.resize(0);
    if (one.doubt_mm.size() > 0) one.doubt_mm.segment(parts[k].first_vertex, parts[k].vertices) = known->second;
    if (one.shape.has.back()) {
      one.shape.points.segment(3 * parts[k].first_vertex, 3 * parts[k].vertices) =
          of[k].read.set.shapes.col(found->second);
      continue;
    }
    const auto doubt = of[k].doubt.find(file);
    one.lacks.push_back("has no " + parts[k].name +
                        (file.empty()                 ? ""
                         : doubt == of[k].doubt.end() ? ", whose file cannot be read"
                                                      : " without doubt: " + doubt->second));
  }
  return one;
}

/// Completes or leaves out the cases that lack a structure; the set then holds all others, by name.
Result<void> settle(std::vector<OneCase> cases, const JointOptions& options, JointSet& joint) {
  std::vector<const OneCase*> whole;
  for (const OneCase& one : cases)
    if (one.lacks.empty()) whole.push_back(&one);
  const std::size_t least = options.complete ? 3 : 2;
  if (whole.size() < least) {
    const auto lacking =
        std::find_if(cases.begin(), cases.end(), [](const OneCase& one) { return !one.lacks.empty(); });
    return fail(lacking == cases.end() ? cases.front().name : lacking->name,
                (lacking == cases.end() ? std::string("is one of too few cases") : lacking->lacks.front()) + ": " +
                    std::to_string(whole.size()) + " of " + std::to_string(cases.size()) +
                    " cases have all structures, and " +
                    (options.complete ? "--complete needs three" : "a joint model needs two") +
                    "; fit more cases, or name fewer structures");
  }
  ShapeMatrix complete(whole.front()->shape.points.size(), std::ssize(whole));
  for (Eigen::Index s = 0; s < complete.cols(); ++s) complete.col(s) = whole[s]->shape.points;
  TrainingSet& set = joint.read.set;
  set.shapes.resize(complete.rows(), std::ssize(cases));
  for (const OneCase& one : cases) {
    const bool has_any = std::find(one.shape.has.begin(), one.shape.has.end(), true) != one.shape.has.end();
    if (!one.lacks.empty() && !(options.complete && has_any)) {
      joint.read.left_out.push_back({one.name, listed(one.lacks, " and "), one.study_keys});
      continue;
    }
    const auto shape = static_cast<Eigen::Index>(set.names.size());
    set.names.push_back(one.name);
    joint.read.groups.push_back(one.group);
    joint.read.study_keys.push_back(one.study_keys);
    set.shapes.col(shape) = one.shape.points;
    if (one.doubt_mm.size() > 0) joint.read.vertex_doubts[one.name] = one.doubt_mm;
    if (one.lacks.empty()) continue;
    const CompletedShape found = completed_shape(complete, joint.parts, one.shape, options.alignment);
    set.shapes.col(shape) = found.points;
    for (std::size_t k = 0; k < joint.parts.size(); ++k)
      if (!one.shape.has[k])
        joint.completed.push_back(
            {shape, static_cast<Eigen::Index>(k), found.expected_error_mm[k], found.mean_error_mm[k]});
  }
  set.shapes.conservativeResize(Eigen::NoChange, std::ssize(set.names));
  if (std::ranges::all_of(joint.read.groups, &std::string::empty)) joint.read.groups.clear();
  return {};
}

}  // namespace

Result<JointSet> read_joint_set(const std::vector<CaseFiles>& cases, const std::vector<std::string>& structures,
                                const JointOptions& options, Progress* progress) {
  std::vector<OneStructure> read;
  JointSet joint;
  for (std::size_t k = 0; k < structures.size(); ++k) {
    const double share = 1.0 / static_cast<double>(structures.size());
    if (progress != nullptr) progress->part(static_cast<double>(k) * share, static_cast<double>(k + 1) * share);
    auto one = read_structure(cases, k, structures[k], options, progress);
    if (!one) return fail(one.error());
    auto& to = joint.read;
    to.warnings.insert(to.warnings.end(), one->read.warnings.begin(), one->read.warnings.end());
    to.doubtful.insert(to.doubtful.end(), one->read.doubtful.begin(), one->read.doubtful.end());
    read.push_back(std::move(*one));
  }
  joint.parts = parts_of(structures, read);
  auto topology = joint_topology(joint.parts, read);
  if (!topology) return fail(topology.error());
  joint.read.set.topology = std::move(*topology);
  std::vector<OneCase> joined;
  for (const CaseFiles& one : cases) joined.push_back(joined_case(one, joint.parts, read));
  if (auto settled = settle(std::move(joined), options, joint); !settled) return fail(settled.error());
  for (std::string& sentence : doubt_warnings(joint.read.doubtful, false))
    joint.read.warnings.push_back(std::move(sentence));
  for (const DoubtfulShape& one : joint.read.left_out)
    joint.read.warnings.push_back(one.name + ": " + one.reason + " (left out)");
  return joint;
}

}  // namespace homolog

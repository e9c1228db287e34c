#include "core/case/actions/mirror.h"

#include "core/case/actions/fields.h"
#include "core/case/placing.h"
#include "core/template/other_side.h"

namespace homolog {

namespace {

Vec3 centroid(const Points& points) {
  return points.colwise().mean().transpose();
}

/// The placement under which the mirrored template is the placed one, mirrored about the sagittal plane through the
/// centroid of `points`, which it has too.
Similarity mirrored_in_place(const Template& mirrored_template, const Similarity& placement, const Points& points) {
  Similarity there = placement;
  const auto& q = placement.rotation;
  there.rotation = Eigen::Quaterniond(q.w(), q.x(), -q.y(), -q.z());
  there.translation += centroid(points) - there.apply(centroid(mirrored_template.points));
  return there;
}

/// Whether landmarks say where the shape lies.
bool is_placed_by_landmarks(const Template& the_template, LandmarkPull pull, const Shape& shape) {
  return pull != LandmarkPull::off && matched_landmarks(the_template, shape.landmarks).first.rows() > 0;
}

void spell_mirror(Fields& line, MirrorTemplate& mirror) {
  line.constant("mirror", "sagittal", "\"mirror\" is not \"sagittal\"");
  if (line.reads()) mirror.keeps_centre = line.has("keeps");
  if (mirror.keeps_centre) line.constant("keeps", "centre", "\"keeps\" is not \"centre\"");
}

Result<EditReport> apply_mirror(const MirrorTemplate& mirror, StructureEdit& edit) {
  const Structure& before = edit.before;
  auto made = make_template(mirrored_with_names(to_mesh_file(*before.the_template)), before.the_template->source);
  if (!made) return fail(made.error());
  edit.after.the_template = *made;
  // It is another organ now.
  edit.after.side = before.side == Side::left ? Side::right : before.side == Side::right ? Side::left : Side::none;
  edit.after.partner = {};
  edit.after.shared.clear();
  for (const auto& [frame, shown] : before.shapes) {
    Shape shape = *shown;
    shape.confirmed.reset();
    if (mirror.keeps_centre && !is_placed_by_landmarks(**made, before.landmarks.pull, shape))
      shape.placement = shape.before_landmarks = mirrored_in_place(**made, shape.placement, *shape.points);
    start_anew(**made, shape);
    if (auto report = carry_to_landmarks(**made, before.landmarks.pull, before.landmarks.rule, shape); !report)
      return fail(report.error());
    edit.after.set_shape(frame, std::move(shape));
  }
  return EditReport{};
}

}  // namespace

const ActionKind<MirrorTemplate>& action_kind(const MirrorTemplate&) {
  static constexpr ActionKind<MirrorTemplate> kind{
      .key = "mirror",
      .example = R"({"mirror":"sagittal","keeps":"centre"})",
      .meaning =
          "goes on with the template of the other side, mirrored where the mesh lies. Without `\"keeps\"`, as older "
          "versions wrote it, the placement stays as it is",
      .name = [](const MirrorTemplate&) -> std::string { return "mirror"; },
      .spell = spell_mirror,
      .apply = apply_mirror};
  return kind;
}

}  // namespace homolog

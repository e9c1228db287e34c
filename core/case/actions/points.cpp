#include "core/case/actions/points.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/numbers/limits.h"
#include "core/case/actions/decided.h"
#include "core/case/actions/fields.h"
#include "core/case/moved_points.h"
#include "core/case/packed.h"
#include "core/case/placing.h"

namespace homolog {

namespace {

constexpr double doubt_steps_per_mm = 256;

constexpr Names<FoundBy, 12> finder_names{{{"fit", FoundBy::fit},
                                           {"fit of the set", FoundBy::set_fit},
                                           {"model help", FoundBy::model},
                                           {"refine", FoundBy::refinement},
                                           {"snap", FoundBy::snap},
                                           {"contours", FoundBy::contours},
                                           {"keep apart", FoundBy::keep_apart},
                                           {"propagate", FoundBy::propagation},
                                           {"start of the cine", FoundBy::start_of_cine},
                                           {"projection", FoundBy::projection},
                                           {"shared vertices", FoundBy::shared},
                                           {"taken back", FoundBy::taken_back}}};
static_assert(finder_names.size() + 1 == enumerators<FoundBy>(), "each value but `other` needs its word");

void spell_finder(Fields& line, PointsFinder& by) {
  std::string word = by.word();
  line.optional("by", word);
  if (line.reads()) by = PointsFinder(word);
}

void spell_doubt_mm(Fields& line, std::size_t vertices, std::shared_ptr<const VertexScalars>& doubt_mm) {
  std::string text;
  if (doubt_mm) {
    std::vector<std::uint32_t> steps;
    for (const double mm : *doubt_mm) steps.push_back(static_cast<std::uint32_t>(mm * doubt_steps_per_mm));
    text = packed<std::uint32_t>(steps);
  }
  line.optional("doubt_mm", text, doubt_mm != nullptr);
  if (!line.reads() || text.empty()) return;
  const auto steps = unpacked<std::uint32_t>(text, vertices);
  if (!steps) throw Unreadable{steps.error().what};
  VertexScalars read(static_cast<Eigen::Index>(vertices));
  std::transform(steps->begin(), steps->end(), read.begin(), [](auto step) { return step / doubt_steps_per_mm; });
  doubt_mm = std::make_shared<const VertexScalars>(std::move(read));
}

void spell_outlier(Fields& line, std::size_t vertices, std::shared_ptr<const VertexScalars>& outlier) {
  std::string text;
  if (outlier) {
    std::vector<std::uint8_t> marks;
    for (const double mark : *outlier) marks.push_back(mark > 0 ? 1 : 0);
    text = packed<std::uint8_t>(marks);
  }
  line.optional("outlier", text, outlier != nullptr);
  if (!line.reads() || text.empty()) return;
  const auto marks = unpacked<std::uint8_t>(text, vertices);
  if (!marks) throw Unreadable{marks.error().what};
  VertexScalars read(static_cast<Eigen::Index>(vertices));
  std::transform(marks->begin(), marks->end(), read.begin(), [](auto mark) { return mark > 0 ? 1 : 0; });
  outlier = std::make_shared<const VertexScalars>(std::move(read));
}

void spell_points(Fields& line, SetPoints& set) {
  std::vector<double> numbers;
  if (set.points) numbers.assign(set.points->data(), set.points->data() + set.points->size());
  line.member("points", numbers);
  if (numbers.size() % 3 != 0) throw Unreadable{"\"points\" is not x, y, z of every vertex"};
  spell_finder(line, set.by);
  line.optional("placement", set.placement);
  line.optional("of_frame", set.of_frame);
  line.optional("doubt", set.doubt, !set.doubt.empty());
  spell_doubt_mm(line, numbers.size() / 3, set.doubt_mm);
  spell_outlier(line, numbers.size() / 3, set.outlier);
  if (line.reads())
    set.points = std::make_shared<const Points>(
        Eigen::Map<const Points>(numbers.data(), static_cast<Eigen::Index>(numbers.size() / 3), 3));
}

void spell_moves(Fields& line, MovePoints& move) {
  spell_finder(line, move.by);
  line.optional("placement", move.placement);
  line.optional("of_frame", move.of_frame);
  line.optional("doubt", move.doubt, !move.doubt.empty());
  Fields moved = line.object("moved");
  std::int64_t vertices = move.moves ? static_cast<std::int64_t>(move.moves->size() / 3) : 0;
  std::string steps = move.moves ? packed<std::uint32_t>(*move.moves) : "";
  moved.member("landmarks", vertices);
  constexpr std::int64_t most_vertices = 1 << 27;
  if (line.reads() && (vertices < 1 || vertices > most_vertices)) throw Unreadable{"\"landmarks\" is out of range"};
  moved.member("steps", steps);
  spell_doubt_mm(line, static_cast<std::size_t>(vertices), move.doubt_mm);
  spell_outlier(line, static_cast<std::size_t>(vertices), move.outlier);
  if (!line.reads()) return;
  auto moves = unpacked<std::uint32_t>(steps, 3 * static_cast<std::size_t>(vertices));
  if (!moves) throw Unreadable{moves.error().what};
  move.moves = std::make_shared<const std::vector<std::uint32_t>>(std::move(*moves));
}

/// Whether such an edit leaves vertices where the fit put them along the surface. Only then does its doubt still hold.
bool keeps_doubt(const PointsFinder& by) {
  return by == FoundBy::model || by == FoundBy::snap || by == FoundBy::keep_apart || by == FoundBy::shared;
}

/// How far an edit moves a vertex that counts as known, mm: any way; but where vertices follow those of another
/// structure, so do all around, however little.
double least_decided_mm(const PointsFinder& by) {
  return by == FoundBy::shared ? 0.01 : 0;
}

/// A fit of the template to contours, not of the mesh that is there.
bool is_drawn_anew(const SetPoints& action) {
  return action.by == FoundBy::contours && action.placement;
}

/// Whether what was pulled before such an edit is still held: a person's place for it goes before that of the image.
bool keeps_pulls(const SetPoints& action) {
  const PointsFinder& by = action.by;
  return by == FoundBy::model || by == FoundBy::snap || by == FoundBy::refinement || by == FoundBy::keep_apart ||
         by == FoundBy::shared || (by == FoundBy::contours && !is_drawn_anew(action));
}

/// Keeps what an edit by `action`, which is not yet done, leaves of what was pulled and of the shape without snaps.
void keep_unsnapped(const SetPoints& action, Shape& shape) {
  if (!keeps_pulls(action)) return forget(Origin::since_fit, shape);
  if (action.by == FoundBy::snap) {
    if (!shape.unsnapped) shape.unsnapped = shape.points;
  } else if (shape.unsnapped) {
    shape.unsnapped = std::make_shared<const Points>(*shape.unsnapped + *action.points - *shape.points);
  }
}

/// The rest that an edit by `action` leaves of the shape without the model's help.
std::shared_ptr<const Points> unaided_by(const SetPoints& action, const Shape& shape) {
  if (action.by == FoundBy::model) {
    Points unaided = unaided_points(shape);
    const bool taken_back = (unaided - *action.points).cwiseAbs().maxCoeff() <= 1 / steps_per_mm;
    return taken_back ? nullptr : std::make_shared<const Points>(std::move(unaided));
  }
  if (!shape.unaided) return nullptr;
  if (action.by == FoundBy::refinement || action.by == FoundBy::shared)
    return std::make_shared<const Points>(*shape.unaided + *action.points - *shape.points);
  Points unaided = unaided_after(*shape.unaided, *shape.points, *action.points);
  return unaided == *action.points ? nullptr : std::make_shared<const Points>(std::move(unaided));
}

Result<EditReport> apply_points(const SetPoints& action, StructureEdit& edit) {
  const Template& the_template = *edit.before.the_template;
  if (!action.points || action.points->rows() != the_template.points.rows()) {
    return fail("points", std::to_string(action.points ? action.points->rows() : 0) + " were given for " +
                              std::to_string(the_template.points.rows()) + " vertices");
  }
  if (!all_in_reach(*action.points))
    return fail("points", std::string("hold a coordinate that is no number, or that ") + beyond_farthest);
  if (action.doubt_mm && action.doubt_mm->size() != the_template.points.rows())
    return fail("doubt_mm", "does not hold one number for each vertex");
  if (action.outlier && action.outlier->size() != the_template.points.rows())
    return fail("outlier", "does not hold one number for each vertex");
  if (action.placement)
    if (auto usable = check_placement(*action.placement, the_template.points); !usable) return fail(usable.error());
  const int frame = action.of_frame.value_or(edit.document.frame);
  if (auto exists = check_frame(edit.document.scan, frame); !exists) return fail(exists.error());
  Shape shape = shape_of_frame(edit.before, edit.document.frame, frame);
  if (action.placement) {
    shape.placement = shape.before_landmarks = *action.placement;
    shape.reference = shape.placed = std::make_shared<const Points>(action.placement->apply(the_template.points));
  }
  shape.unaided = unaided_by(action, shape);
  if (action.by != FoundBy::model && action.by != FoundBy::refinement) {
    const auto moved_mm2 = (*action.points - *shape.points).rowwise().squaredNorm().array();
    const double least_mm = least_decided_mm(action.by);
    decide(shape, std::make_shared<const VertexScalars>((moved_mm2 > least_mm * least_mm).cast<double>()));
  }
  keep_unsnapped(action, shape);
  shape.points = action.points;
  forget(Origin::step, shape);
  if (action.by == FoundBy::propagation) shape.carried = action.points;
  shape.doubt = action.doubt;
  if (!keeps_doubt(action.by)) {
    forget(Origin::fit, shape);
    shape.doubt_mm = action.doubt_mm;
    shape.outlier = action.outlier;
  }
  ++shape.strokes;
  if (is_drawn_anew(action)) shape.drawn_strokes = shape.strokes;
  edit.after.set_shape(frame, std::move(shape));
  return EditReport{};
}

Result<EditReport> apply_moves(const MovePoints& action, StructureEdit& edit) {
  const int frame = action.of_frame.value_or(edit.document.frame);
  const auto points = points_of(*shape_of_frame(edit.before, edit.document.frame, frame).points, action);
  if (!points) return fail(points.error());
  return apply_points(*points, edit);
}

std::string name_of_points(const PointsFinder& by) {
  const std::string word = by.word();
  return word.empty() ? "points" : word;
}

}  // namespace

PointsFinder::PointsFinder(const std::string& word) : PointsFinder() {
  for (const auto& [name, known] : finder_names)
    if (word == name) by_ = known;
  if (by_ == FoundBy::other) unknown_ = word;
}

std::string PointsFinder::word() const {
  return by_ == FoundBy::other ? unknown_ : name_of(finder_names, by_);
}

const ActionKind<SetPoints>& action_kind(const SetPoints&) {
  static constexpr ActionKind<SetPoints> kind{
      .key = "points",
      .example = R"({"points":[-21,20,-9,-19,17,-9],"by":"fit"})",
      .meaning =
          "moves every vertex to where an automatic step found it: x, y, z of the first vertex, then of the "
          "next. Scripts and older versions write this. With `\"placement\":{…}` the reference moves there too. "
          "Vertices that moved count as known, except with `\"by\":\"model help\"` and "
          "`\"by\":\"refine\"`. `\"of_frame\":K`: of that frame of a cine, whichever is shown. "
          "`\"by\":\"propagate\"` says that the mesh came from other frames, and `\"doubt\"` why it has to be looked "
          "at. `\"doubt_mm\":\"…\"`: a fit's doubt at each vertex, in steps of 2⁻⁸ mm, packed as `steps` are. "
          "`\"outlier\":\"…\"`: 1 for each vertex whose place the scan lacks, else 0, a byte each, packed likewise",
      .name = [](const SetPoints& set) { return name_of_points(set.by); },
      .spell = spell_points,
      .apply = apply_points};
  return kind;
}

const ActionKind<MovePoints>& action_kind(const MovePoints&) {
  static constexpr ActionKind<MovePoints> kind{
      .key = "moved",
      .example = R"({"by":"snap","moved":{"landmarks":2,"steps":"eAEVwYEJAAAMAiCD/f9yI5WjpoKaPihqBAM="}})",
      .meaning = "the same as how far each coordinate moved (below): what Homolog writes",
      .name = [](const MovePoints& move) { return name_of_points(move.by); },
      .spell = spell_moves,
      .apply = apply_moves};
  return kind;
}

std::shared_ptr<const VertexScalars> doubt_on_grid(const VertexScalars& doubt_mm) {
  constexpr double most_steps = std::numeric_limits<std::uint32_t>::max();
  return std::make_shared<const VertexScalars>(
      (doubt_mm * doubt_steps_per_mm).array().max(0).min(most_steps).round().matrix() / doubt_steps_per_mm);
}

SetPoints points_edit(const ShapeView& shown, const Points& points, PointsFinder by,
                      const std::optional<Similarity>& placement) {
  SetPoints edit = points_edit(shown, shown.frame, points, std::move(by));
  edit.placement = placement;
  edit.of_frame.reset();
  return edit;
}

SetPoints points_edit(const ShapeView& shown, int frame, const Points& points, PointsFinder by) {
  Points rounded = *shape_of_frame(shown.structure, shown.frame, frame).points;
  if (points.rows() != rounded.rows()) rounded = points;  // applying it says what is wrong
  for (Eigen::Index k = 0; k < rounded.size(); ++k)
    if (const double to = points.data()[k]; to != rounded.data()[k]) rounded.data()[k] = on_grid(to);
  return {std::move(by), std::nullopt, std::make_shared<const Points>(std::move(rounded)), frame, {}, {}, {}};
}

}  // namespace homolog

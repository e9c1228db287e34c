#include "core/adapt/labels/choose_closing.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/measure/compare.h"
#include "core/mesh/construction/remesh.h"
#include "core/mesh/formats/text.h"
#include "core/mesh/mesh_io.h"
#include "core/template_making/label_body.h"

namespace homolog {

namespace {

constexpr std::string_view closing_key = "homolog.closing_mm ";
/// By so much raw Dice may fall for a sound fit: what a filled cleft costs by itself.
constexpr double next_to_same = 0.003;
/// The same where the label's own clefts are no trouble, and others' may be.
constexpr double next_to_nothing = 0.001;

/// The fit with one radius. Errors: label_boundary's and fit_to_boundary's.
Result<OtherClosing> fit_closed_by(const Template& the_template, const Volume& mask, int label, int frame,
                                   double closing_mm, const FitOptions& options) {
  auto boundary = label_boundary(mask, label, frame, closing_mm, the_template.points.rows());
  if (!boundary) return fail(boundary.error());
  auto fit = fit_to_boundary(the_template, *boundary, options);
  if (!fit) return fail(fit.error());
  auto judgement = judge_fit(the_template, *boundary, options, *fit);
  return OtherClosing{closing_mm, std::move(*boundary), std::move(*fit), std::move(judgement)};
}

TriedClosing tried_as(const OtherClosing& fitted, const Volume& mask, int label, int frame) {
  return {fitted.closing_mm, dice_with_mask(fitted.fit.mesh, mask, label, frame), fitted.judgement.doubtful};
}

bool may_be_clefts(const OtherClosing& fitted) {
  constexpr double of_the_same_organ = 0.5;  // Dice; below, it is likely another one
  return fitted.judgement.doubtful && !fitted.fit.mirrored && !fitted.fit.half_turned &&
         fitted.boundary.scan_borders.empty() && fitted.judgement.agreement.dice > of_the_same_organ;
}

}  // namespace

double usual_closing_mm(const Volume& mask, int label, int frame) {
  return ball_share * organ_size_mm(label_extent(mask, label, frame));
}

std::vector<double> wider_closings_mm(const Volume& mask, int label, int frame, Eigen::Index vertices) {
  const double edge_mm = spread_edge_mm(label_extent(mask, label, frame).area_mm2, vertices);
  if (!(edge_mm > 0)) return {};
  return {edge_mm, 1.25 * edge_mm};
}

ClosingChoice choose_template_closing(const Volume& mask, const MaskTemplateOptions& options, Progress* progress) {
  constexpr double stand_in_edges = 1.5;
  ClosingChoice choice;
  choice.closing_mm = usual_closing_mm(mask, options.label, options.frame);
  choice.why = "a template without the clefts fits the label soundly";
  const auto wider = wider_closings_mm(mask, options.label, options.frame, options.vertices);
  if (wider.empty()) return choice;
  std::optional<Progress> silent;  // it can be cancelled, and counts as next to no time
  if (progress != nullptr) silent.emplace(*progress, 0);
  Progress* trial = silent ? &*silent : nullptr;
  MaskTemplateOptions making = options;
  making.closing_mm = stand_in_edges * wider.front();
  const auto stand_in = make_mask_template(mask, making, trial);
  if (!stand_in) return choice;
  const auto the_template = make_template({stand_in->mesh.points, stand_in->mesh.topology->triangles()}, "stand-in");
  if (!the_template) return choice;
  FitOptions fitting;
  fitting.progress = trial;
  const auto first = fit_closed_by(**the_template, mask, options.label, options.frame, choice.closing_mm, fitting);
  if (!first) return choice;
  choice.tried.push_back(tried_as(*first, mask, options.label, options.frame));
  const bool clefts = may_be_clefts(*first);
  if (!clefts && (first->judgement.doubtful || !first->boundary.scan_borders.empty())) return choice;
  if (clefts) choice.why = "no wider radius gave a sounder fit";
  making.closing_mm = choice.closing_mm;
  const auto usual = make_mask_template(mask, making, trial);
  if (!usual || stand_in->mesh.topology->genus() > usual->mesh.topology->genus()) {
    choice.why = "wider radii make tunnels";
    return choice;
  }
  const double least = choice.tried.front().dice_raw - (clefts ? next_to_same : next_to_nothing);
  for (const double closing_mm : wider) {
    if (closing_mm <= choice.closing_mm || (!clefts && closing_mm > wider.front())) continue;
    const auto fitted = fit_closed_by(**the_template, mask, options.label, options.frame, closing_mm, fitting);
    if (!fitted) continue;
    choice.tried.push_back(tried_as(*fitted, mask, options.label, options.frame));
    const TriedClosing& last = choice.tried.back();
    if (last.doubtful || last.dice_raw < least) continue;
    choice.closing_mm = closing_mm;
    choice.why = clefts ? "with " + mm_words(choice.tried.front().closing_mm) +
                              " a template without the clefts is not followed into them; with this it fits soundly"
                        : "it costs next to nothing here, and others' clefts may be deeper";
  }
  return choice;
}

std::string closing_comment(double closing_mm) {
  char number[32];
  std::snprintf(number, sizeof number, "%.6g", closing_mm);
  return std::string(closing_key) + number;
}

std::optional<double> closing_kept_with(const std::string& source) {
  std::error_code ignored;
  if (!is_mesh_name(source) || !std::filesystem::exists(source, ignored)) return std::nullopt;
  const auto file = read_mesh_file(source);
  if (!file) return std::nullopt;
  for (const std::string& comment : file->comments) {
    if (!comment.starts_with(closing_key)) continue;
    const auto mm = formats::to_number<double>(std::string_view(comment).substr(closing_key.size()));
    if (mm && *mm >= 0 && *mm < 1000) return *mm;
  }
  return std::nullopt;
}

MoreClosing try_more_closing(const Template& the_template, const Volume& mask, int label, int frame,
                             const LabelParts& parts, const FitOptions& options, const OtherClosing& first) {
  MoreClosing more;
  if (options.partial || parts.all || the_template.faced || first.boundary.parts_alike > 1 || !may_be_clefts(first))
    return more;
  more.tried.push_back(tried_as(first, mask, label, frame));
  double best = more.tried.front().dice_raw - next_to_same;
  FitOptions again = options;
  std::optional<Progress> silent;
  if (options.progress != nullptr) again.progress = &silent.emplace(*options.progress, 0);
  again.show = {};
  FitOptions roughly = again;
  roughly.rough = true;
  for (const double closing_mm : wider_closings_mm(mask, label, frame, the_template.points.rows())) {
    if (closing_mm <= first.closing_mm) continue;
    // Where a rough fit does not follow the closed label, a whole one does not either: its other ways tell of doubt.
    auto fitted = fit_closed_by(the_template, mask, label, frame, closing_mm, roughly);
    if (fitted && !fitted->judgement.doubtful)
      fitted = fit_closed_by(the_template, mask, label, frame, closing_mm, again);
    if (!fitted) continue;
    more.tried.push_back(tried_as(*fitted, mask, label, frame));
    const TriedClosing& last = more.tried.back();
    if (last.doubtful || last.dice_raw < best) continue;
    best = last.dice_raw;
    more.better = std::move(*fitted);
  }
  if (more.tried.size() == 1) more.tried.clear();
  return more;
}

std::string mm_words(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f mm", mm);
  return text;
}

std::string tried_in_vain(const std::vector<TriedClosing>& tried) {
  std::string text = "closing by";
  for (std::size_t k = 1; k < tried.size(); ++k) text += (k > 1 ? " and " : " ") + mm_words(tried[k].closing_mm);
  char dice[64];
  double best = 0;
  for (std::size_t k = 1; k < tried.size(); ++k) best = std::max(best, tried[k].dice_raw);
  std::snprintf(dice, sizeof dice, " was tried and helps no more (raw Dice %.3f)", best);
  return text + dice;
}

}  // namespace homolog

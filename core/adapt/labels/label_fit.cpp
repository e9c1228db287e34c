#include "core/adapt/labels/label_fit.h"

#include <algorithm>
#include <utility>

#include "core/adapt/labels/likeliest_part.h"
#include "core/volume/check_volume.h"

namespace homolog {

namespace {

bool takes_all_parts(const Template& the_template, const LabelFitOptions& options, bool partial) {
  return partial || options.all_parts.value_or(parts_for(*the_template.topology).all);
}

}  // namespace

double first_closing_mm(const MapLabel& target, const LabelFitOptions& options) {
  if (options.closing_mm) return *options.closing_mm;
  return options.kept_closing_mm ? *options.kept_closing_mm : usual_closing_mm(target.map, target.label, target.frame);
}

Result<Boundary> boundary_to_fit(const Template& the_template, const MapLabel& target, const LabelFitOptions& options,
                                 double closing_mm, const FitOptions& fitting) {
  std::vector<std::string> warnings;
  LabelParts parts = parts_for(the_template, target.known, warnings);
  parts.all = takes_all_parts(the_template, options, fitting.partial);
  const auto part = [&](std::size_t rank) {
    parts.rank = rank;
    return label_boundary(target.map, target.label, target.frame, closing_mm, the_template.points.rows(), parts);
  };
  auto boundary = part(0);
  if (boundary && !parts.all && !options.largest_part)
    boundary = likeliest_part(the_template, std::move(*boundary), part, fitting);
  if (boundary && !warnings.empty()) {
    boundary->why_whole = warnings.front();
    boundary->warnings.insert(boundary->warnings.begin(), warnings.begin(), warnings.end());
  }
  return boundary;
}

Result<LabelFit> fit_to_label(const Template& the_template, const MapLabel& target, const LabelFitOptions& options,
                              const FitOptions& fitting) {
  if (auto sound = check_frame_of(target.map, target.frame); !sound) return fail(sound.error());
  if (auto sound = check_arguments(the_template, fitting); !sound) return fail(sound.error());
  OtherClosing taken;
  taken.closing_mm = first_closing_mm(target, options);
  auto boundary = boundary_to_fit(the_template, target, options, taken.closing_mm, fitting);
  if (!boundary) return fail(boundary.error());
  taken.boundary = std::move(*boundary);
  auto fit = fit_to_boundary(the_template, taken.boundary, fitting);
  if (!fit) return fail(fit.error());
  taken.fit = std::move(*fit);
  taken.judgement = judge_fit(the_template, taken.boundary, fitting, taken.fit);
  MoreClosing more;
  if (!options.closing_mm) {
    const LabelParts parts{.all = takes_all_parts(the_template, options, fitting.partial)};
    more = try_more_closing(the_template, target.map, target.label, target.frame, parts, fitting, taken);
  }
  const bool widened = more.better.has_value();
  if (widened) {
    // What is said of the first boundary, as of parts that were left out, holds for the wider one too.
    auto& said = more.better->judgement.warnings;
    said.erase(said.begin(), said.begin() + std::ssize(more.better->boundary.warnings));
    said.insert(said.begin(), taken.boundary.warnings.begin(), taken.boundary.warnings.end());
    more.better->boundary.warnings = std::move(taken.boundary.warnings);
    taken = std::move(*more.better);
  } else if (!more.tried.empty()) {
    // The last one is the reason of the doubt [reason_of_doubt], and the boundary's come first.
    auto& said = taken.judgement.warnings;
    const auto first = std::ssize(taken.boundary.warnings);
    said.insert(said.begin() + std::max(first, std::ssize(said) - 1), tried_in_vain(more.tried));
  }
  return LabelFit{
      std::move(taken.boundary), std::move(taken.fit), std::move(taken.judgement), taken.closing_mm, widened,
      std::move(more.tried)};
}

std::string why_closing(const LabelFit& fitted, const LabelFitOptions& options) {
  if (options.closing_mm) return "as asked for";
  if (fitted.widened)
    return "with " + mm_words(fitted.tried.front().closing_mm) + " the fit was doubtful, with this it is not";
  if (!fitted.tried.empty()) return "wider radii were tried and are no better";
  return options.kept_closing_mm ? "kept with the template" : "usual for the label's size";
}

}  // namespace homolog

#include "app/editor/scene/mesh_colouring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/adapt/judge_fit.h"
#include "core/base/enumerators.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

Rgb mix(const Rgb& a, const Rgb& b, double share) {
  const auto t = static_cast<float>(std::clamp(share, 0.0, 1.0));
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

Rgb on_scale(const std::vector<Rgb>& scale, double share) {
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(scale.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), scale.size() - 2);
  return mix(scale[low], scale[low + 1], place - static_cast<double>(low));
}

const std::vector<Rgb>& quality_scale() {
  static const std::vector<Rgb> scale{
      {0.64f, 0.02f, 0.16f}, {0.93f, 0.48f, 0.22f}, {0.97f, 0.77f, 0.48f}, {0.93f, 0.94f, 0.95f}};
  return scale;
}

constexpr double stretch_octaves = 1;  // the scale's ends: half and double the length

/// The largest distance of a scale: a round number that the mesh fills.
double scale_mm(double largest) {
  for (const double step : {2.0, 5.0, 10.0, 20.0, 50.0})
    if (largest <= step) return step;
  return 100;
}

double moved_scale_mm(const ShapeView& shown) {
  return scale_mm(moved_mm(shown).maxCoeff());
}

/// One, two or five times a power of ten, and not below `mm`.
double rounded_up(double mm) {
  const double power = std::pow(10, std::floor(std::log10(std::max(mm, 1e-6))));
  for (const double step : {1.0, 2.0, 5.0})
    if (mm <= step * power) return step * power;
  return 10 * power;
}

/// From where on a place has to be looked at, so that a colour means the same on every mesh of the organ's size.
double doubt_scale_mm(const ShapeView& shown) {
  return rounded_up(much_doubt_mm(surface_area_mm2(shown.mesh())));
}

/// The largest factor of the scale; the factor 1 stays well below the white of confirmed regions.
double stiffness_scale(const ShapeView& shown) {
  return std::max(shown.paint().stiffness->maxCoeff(), 2.0);
}

constexpr Rgb decided{0.30f, 0.72f, 0.62f}, left_open{0.62f, 0.52f, 0.85f};
constexpr Rgb no_region{0.80f, 0.81f, 0.83f};

Rgb rgb_of(const std::array<std::uint8_t, 3>& colour) {
  return {static_cast<float>(colour[0]) / 255, static_cast<float>(colour[1]) / 255,
          static_cast<float>(colour[2]) / 255};
}

/// An outline lies on the grey image: without a region it has a colour that no tissue has, and no new region gets.
constexpr Rgb no_region_outline{0.20f, 1.00f, 0.95f};

Rgb region_colour(const Regions& regions, std::size_t vertex, bool of_outline) {
  const std::uint8_t number = regions.of_vertex.empty() ? 0 : regions.of_vertex[vertex];
  return number == 0 ? of_outline ? no_region_outline : no_region : rgb_of(regions.list[number - 1U].colour);
}

/// Quality of the worst triangle around every vertex.
VertexScalars worst_triangle(const ShapeView& shown) {
  const Topology& topology = *shown.the_template().topology;
  const Points& p = *shown.shape.points;
  VertexScalars worst = VertexScalars::Ones(p.rows());
  for (Eigen::Index face = 0; face < topology.triangles().rows(); ++face) {
    const auto t = topology.triangles().row(face);
    const double quality = triangle_quality(p.row(t[0]), p.row(t[1]), p.row(t[2]));
    for (int corner = 0; corner < 3; ++corner) worst[t[corner]] = std::min(worst[t[corner]], quality);
  }
  return worst;
}

std::string figure_text(const char* pattern, double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), pattern, value);
  return text.data();
}

}  // namespace

VertexScalars moved_mm(const ShapeView& shown) {
  return (*shown.shape.points - *shown.shape.reference).rowwise().norm();
}

VertexScalars edge_stretch(const ShapeView& shown) {
  const Topology& topology = *shown.the_template().topology;
  const Points& p = *shown.shape.points;
  const Points& r = shown.the_template().points;
  const double scale = shown.shape.placement.scale;
  VertexScalars sum = VertexScalars::Zero(p.rows()), count = VertexScalars::Zero(p.rows());
  for (const auto& [i, j] : topology.edges()) {
    const double before = scale * (r.row(i) - r.row(j)).norm();
    if (before <= 0) continue;
    const double ratio = (p.row(i) - p.row(j)).norm() / before;
    for (const auto vertex : {i, j}) {
      sum[vertex] += ratio;
      count[vertex] += 1;
    }
  }
  return sum.cwiseQuotient(count.cwiseMax(1));
}

std::vector<Rgb> tinted(std::vector<Rgb> colours, const VertexScalars& response, bool stopped) {
  const Rgb rest{0.55f, 0.56f, 0.58f}, moving = stopped ? Rgb{1.0f, 0.66f, 0.25f} : Rgb{1, 1, 1};
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const double follows = std::clamp(response[static_cast<Eigen::Index>(i)], 0.0, 1.0);
    colours[i] = mix(mix(colours[i], rest, 0.35 * (1 - follows)), moving, (stopped ? 0.85 : 0.65) * follows);
  }
  return colours;
}

namespace {

void colour_by(const VertexScalars& values, const std::vector<Rgb>& scale, const auto& share,
               std::vector<Rgb>& colours) {
  for (std::size_t i = 0; i < colours.size(); ++i)
    colours[i] = on_scale(scale, share(values[static_cast<Eigen::Index>(i)]));
}

void whiten_confirmed(const ShapeView& shown, std::vector<Rgb>& colours) {
  const auto& confirmed = shown.shape.confirmed;
  for (std::size_t i = 0; confirmed && i < colours.size(); ++i)
    colours[i] = mix(colours[i], {1, 1, 1}, (*confirmed)[static_cast<Eigen::Index>(i)]);
}

// What each row does.

void colour_hues(const ColouringInput& of, std::vector<Rgb>& colours) {
  for (std::size_t i = 0; i < colours.size(); ++i) colours[i] = hsv_to_rgb(of.hues[i], of.saturation, 1);
}
Legend hue_legend(const ShapeView& shown) {
  Legend legend{
      "0", "", figure_text("%.0f", static_cast<double>(shown.the_template().topology->vertices() - 1)), {}, {}};
  for (int i = 0; i <= 12; ++i) legend.colours.push_back(hsv_to_rgb(static_cast<float>(i) / 12.5f, 0.4f, 1));
  return legend;
}

void colour_structure(const ColouringInput& of, std::vector<Rgb>& colours) {
  std::fill(colours.begin(), colours.end(), structure_colour(of.shown.structure));
}
Legend structure_legend(const ShapeView& shown) {
  return {"", "", "", {structure_colour(shown.structure)}, {structure_name(shown.structure)}};
}

double share_of_stretch(double ratio) {
  return 0.5 + std::log2(std::max(ratio, 1e-6)) / (2 * stretch_octaves);
}
void colour_stretch(const ColouringInput& of, std::vector<Rgb>& colours) {
  colour_by(edge_stretch(of.shown), diverging_scale(), share_of_stretch, colours);
}
Legend stretch_legend(const ShapeView&) {
  return {"0.5\xc3\x97", "1\xc3\x97", "2\xc3\x97", diverging_scale(), {}};
}

void colour_moved(const ColouringInput& of, std::vector<Rgb>& colours) {
  const double most = moved_scale_mm(of.shown);
  colour_by(
      moved_mm(of.shown), rising_scale(), [most](double distance) { return distance / most; }, colours);
}
Legend moved_legend(const ShapeView& shown) {
  return {"0 mm", "", figure_text("%.0f mm", moved_scale_mm(shown)), rising_scale(), {}};
}

void colour_stiffness(const ColouringInput& of, std::vector<Rgb>& colours) {
  const double most = stiffness_scale(of.shown);
  colour_by(
      *of.shown.paint().stiffness, rising_scale(), [most](double factor) { return factor / most; }, colours);
}
Legend stiffness_legend(const ShapeView& shown) {
  return {"0 soft", "", "stiff " + figure_text("%.1f\xc3\x97", stiffness_scale(shown)), rising_scale(), {}};
}

void colour_regions(const ColouringInput& of, std::vector<Rgb>& colours) {
  for (std::size_t i = 0; i < colours.size(); ++i)
    colours[i] = region_colour(*of.shown.paint().regions, i, of.saturation >= 1);
}
Legend regions_legend(const ShapeView& shown) {
  Legend legend{"", "", "", {no_region}, {"no region"}};
  for (const Region& region : shown.paint().regions->list) {
    legend.colours.push_back(rgb_of(region.colour));
    legend.names.push_back(region.name);
  }
  return legend;
}

void colour_quality(const ColouringInput& of, std::vector<Rgb>& colours) {
  colour_by(
      worst_triangle(of.shown), quality_scale(), [](double quality) { return quality; }, colours);
}
Legend quality_legend(const ShapeView&) {
  return {"flat", "", "equilateral", quality_scale(), {}};
}

void colour_known(const ColouringInput& of, std::vector<Rgb>& colours) {
  const VertexScalars known = known_vertices(of.shown.shape);
  for (std::size_t i = 0; i < colours.size(); ++i)
    colours[i] = mix(left_open, decided, known[static_cast<Eigen::Index>(i)]);
  whiten_confirmed(of.shown, colours);  // its legend has a name for them
}
Legend known_legend(const ShapeView&) {
  return {"", "", "", {{1, 1, 1}, decided, left_open}, {"confirmed", "decided by hand, fit or snap", "not known yet"}};
}

void colour_doubt(const ColouringInput& of, std::vector<Rgb>& colours) {
  const VertexScalars doubt_mm = doubt_left_mm(of.shown.shape);
  std::fill(colours.begin(), colours.end(), no_region);
  if (doubt_mm.size() == 0) return;
  const double most = doubt_scale_mm(of.shown);
  colour_by(
      doubt_mm, doubt_scale(), [most](double mm) { return mm / most; }, colours);
}
Legend doubt_legend(const ShapeView& shown) {
  if (!shown.shape.doubt_mm) return {"", "", "", {no_region}, {"not known: a fit to a label map tells it"}};
  return {"0 mm", "", "\xe2\x89\xa5 " + figure_text("%.3g mm", doubt_scale_mm(shown)), doubt_scale(), {}};
}

constexpr double most_z = 3;  ///< as modes are shown to 3 standard deviations

void colour_score(const ColouringInput& of, std::vector<Rgb>& colours) {
  if (of.z != nullptr)
    colour_by(
        *of.z, diverging_scale(), [](double z) { return 0.5 + z / (2 * most_z); }, colours);
}
Legend score_legend(const ShapeView&) {
  return {"\xe2\x88\x92" + figure_text("%.0f \xcf\x83", most_z),
          "0",
          figure_text("%+.0f \xcf\x83", most_z),
          diverging_scale(),
          {}};
}

void colour_confidence(const ColouringInput& of, std::vector<Rgb>& colours) {
  if (of.confidence != nullptr)
    colour_by(
        *of.confidence, confidence_scale(), [](double sure) { return sure; }, colours);
}
Legend confidence_legend(const ShapeView&) {
  return {"no edge seen", "", "clear edge", confidence_scale()};
}

}  // namespace

const std::array<ColouringKind, colourings>& colouring_kinds() {
  static constexpr std::array<ColouringKind, colourings> kinds{{
      {.colouring = Colouring::vertex_hue,
       .log_name = "landmark hue",
       .name = "Hue",
       .title = "Hue of the vertex",
       .tip = "Each vertex in its own hue, the same in all cases",
       .colour = colour_hues,
       .legend = hue_legend},
      {.colouring = Colouring::structure,
       .log_name = "structure",
       .name = "Own",
       .title = "Structure",
       .tip = "Each structure in its own colour, as in the list (Structures)",
       .colour = colour_structure,
       .legend = structure_legend},
      {.colouring = Colouring::edge_stretch,
       .log_name = "edge stretch",
       .name = "Stretch",
       .title = "Stretch of edges",
       .tip = "Edge length: blue is shorter than on the template, red is longer",
       .follows_shape = true,
       .colour = colour_stretch,
       .legend = stretch_legend},
      {.colouring = Colouring::moved,
       .log_name = "moved",
       .name = "Moved",
       .title = "Moved",
       .tip = "How far each vertex has moved since placement and warp",
       .follows_shape = true,
       .colour = colour_moved,
       .legend = moved_legend},
      {.colouring = Colouring::stiffness,
       .log_name = "stiffness",
       .name = "Stiff",
       .title = "Stiffness",
       .tip = "Stiffness factor: dark is soft, bright is stiff. Confirmed vertices are white",
       .whitens_confirmed = true,
       .colour = colour_stiffness,
       .legend = stiffness_legend},
      {.colouring = Colouring::regions,
       .log_name = "regions",
       .name = "Regions",
       .title = "Regions",
       .tip = "Regions of the template in their colours",
       .colour = colour_regions,
       .legend = regions_legend},
      {.colouring = Colouring::quality,
       .log_name = "quality",
       .name = "Triangles",
       .title = "Shape of triangles",
       .tip = "Shape of the triangles: red is thin or turned over",
       .follows_shape = true,
       .colour = colour_quality,
       .legend = quality_legend},
      {.colouring = Colouring::known,
       .log_name = "known",
       .name = "Known",
       .title = "Known",
       .tip = "Which vertices are known: confirmed, or moved there by a stroke, a fit or a snap",
       .follows_shape = true,
       .colour = colour_known,
       .legend = known_legend},
      {.colouring = Colouring::doubt,
       .log_name = "doubt",
       .name = "Doubt",
       .title = "Doubt",
       .tip = "How far from its place each vertex may lie (mm), as the last fit found. Confirmed vertices are white",
       .follows_shape = true,
       .whitens_confirmed = true,
       .colour = colour_doubt,
       .legend = doubt_legend},
      {.colouring = Colouring::score,
       .log_name = "score",
       .name = "Score",
       .title = "Score against the model",
       .tip = "How far each vertex lies outside the model's mean (red) or inside (blue) along its normal, in standard "
              "deviations of the training shapes. The model is chosen in the section Score",
       .colour = colour_score,
       .legend = score_legend},
      {.colouring = Colouring::confidence,
       .log_name = "confidence",
       .name = "Confidence",
       .title = "Confidence of the snap",
       .tip =
           "Confidence of the last snap: how clear the image edge is at each vertex. It does not say that the mesh is "
           "right. Confirmed vertices are white",
       .whitens_confirmed = true,
       .colour = colour_confidence,
       .legend = confidence_legend},
  }};
  static_assert(has_row_of_each<Colouring>(kinds, &ColouringKind::colouring),
                "a row for each Colouring, in their order");
  return kinds;
}

const ColouringKind& kind_of(Colouring colouring) {
  return colouring_kinds()[static_cast<std::size_t>(colouring)];
}

std::vector<Rgb> mesh_colours(const ShapeView& shown, Colouring colouring, const std::vector<float>& hues,
                              float saturation, const VertexScalars* confidence, const VertexScalars* z) {
  std::vector<Rgb> colours(static_cast<std::size_t>(shown.shape.points->rows()));
  const ColouringKind& kind = kind_of(colouring);
  kind.colour({shown, hues, saturation, confidence, z}, colours);
  if (kind.whitens_confirmed) whiten_confirmed(shown, colours);
  if (const auto& outlier = shown.shape.outlier)
    for (std::size_t i = 0; i < colours.size(); ++i)
      colours[i] = mix(colours[i], outlier_grey, (*outlier)[static_cast<Eigen::Index>(i)]);
  return colours;
}

Legend colouring_legend(const ShapeView& shown, Colouring colouring) {
  const ColouringKind& kind = kind_of(colouring);
  Legend legend = kind.legend(shown);
  const auto& outlier = shown.shape.outlier;
  legend.has_outliers = outlier && outlier->maxCoeff() > 0;
  const auto& confirmed = shown.shape.confirmed;
  legend.has_confirmed = kind.whitens_confirmed && confirmed && confirmed->maxCoeff() > 0;
  return legend;
}

}  // namespace homolog

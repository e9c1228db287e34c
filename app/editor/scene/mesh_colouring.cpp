#include "app/editor/scene/mesh_colouring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/adapt/judge_fit.h"
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

// Scales that differ in lightness as well as in hue, so that they are read without colour vision: every other step of
// nine is told apart by all eyes (tests/app/editor/colour_vision_test.cpp).
const std::vector<Rgb>& diverging() {
  static const std::vector<Rgb> scale{{0.13f, 0.35f, 0.85f},
                                      {0.55f, 0.72f, 0.95f},
                                      {0.93f, 0.93f, 0.93f},
                                      {0.96f, 0.62f, 0.47f},
                                      {0.82f, 0.16f, 0.16f}};
  return scale;
}
const std::vector<Rgb>& rising() {
  static const std::vector<Rgb> scale{{0.17f, 0.19f, 0.38f},
                                      {0.15f, 0.45f, 0.56f},
                                      {0.29f, 0.69f, 0.49f},
                                      {0.68f, 0.85f, 0.32f},
                                      {1.00f, 0.97f, 0.70f}};
  return scale;
}
const std::vector<Rgb>& quality_scale() {
  static const std::vector<Rgb> scale{
      {0.64f, 0.02f, 0.16f}, {0.93f, 0.48f, 0.22f}, {0.97f, 0.77f, 0.48f}, {0.93f, 0.94f, 0.95f}};
  return scale;
}

const std::vector<Rgb>& confidence_scale() {
  static const std::vector<Rgb> scale{{0.80f, 0.10f, 0.32f}, {0.97f, 0.62f, 0.30f}, {0.60f, 0.98f, 0.88f}};
  return scale;
}

/// From sure to doubtful: the confidence, read from its other end.
const std::vector<Rgb>& doubt_scale() {
  static const std::vector<Rgb> scale(confidence_scale().rbegin(), confidence_scale().rend());
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

std::vector<Rgb> mesh_colours(const ShapeView& shown, Colouring colouring, const std::vector<float>& hues,
                              float saturation, const VertexScalars* confidence) {
  const auto n = static_cast<std::size_t>(shown.shape.points->rows());
  std::vector<Rgb> colours(n);
  const auto colour_by = [&](const VertexScalars& values, const std::vector<Rgb>& scale, auto share) {
    for (std::size_t i = 0; i < n; ++i) colours[i] = on_scale(scale, share(values[static_cast<Eigen::Index>(i)]));
  };
  const auto whiten_confirmed = [&] {
    const auto& confirmed = shown.shape.confirmed;
    for (std::size_t i = 0; confirmed && i < n; ++i)
      colours[i] = mix(colours[i], {1, 1, 1}, (*confirmed)[static_cast<Eigen::Index>(i)]);
  };
  switch (colouring) {
    case Colouring::vertex_hue:
      for (std::size_t i = 0; i < n; ++i) colours[i] = hsv_to_rgb(hues[i], saturation, 1);
      break;
    case Colouring::edge_stretch:
      colour_by(edge_stretch(shown), diverging(),
                [](double ratio) { return 0.5 + std::log2(std::max(ratio, 1e-6)) / (2 * stretch_octaves); });
      break;
    case Colouring::moved:
      colour_by(moved_mm(shown), rising(), [most = moved_scale_mm(shown)](double distance) { return distance / most; });
      break;
    case Colouring::stiffness: {
      const double most = stiffness_scale(shown);
      colour_by(*shown.paint().stiffness, rising(), [most](double factor) { return factor / most; });
      whiten_confirmed();
      break;
    }
    case Colouring::regions:
      for (std::size_t i = 0; i < n; ++i) colours[i] = region_colour(*shown.paint().regions, i, saturation >= 1);
      break;
    case Colouring::known: {
      const VertexScalars known = known_vertices(shown.shape);
      for (std::size_t i = 0; i < n; ++i) colours[i] = mix(left_open, decided, known[static_cast<Eigen::Index>(i)]);
      whiten_confirmed();
      break;
    }
    case Colouring::doubt: {
      const VertexScalars doubt_mm = doubt_left_mm(shown.shape);
      std::fill(colours.begin(), colours.end(), no_region);
      if (doubt_mm.size() > 0)
        colour_by(doubt_mm, doubt_scale(), [most = doubt_scale_mm(shown)](double mm) { return mm / most; });
      whiten_confirmed();
      break;
    }
    case Colouring::confidence:
      if (confidence != nullptr) colour_by(*confidence, confidence_scale(), [](double sure) { return sure; });
      whiten_confirmed();
      break;
    case Colouring::quality:
      colour_by(worst_triangle(shown), quality_scale(), [](double quality) { return quality; });
      break;
  }
  if (const auto& outlier = shown.shape.outlier)
    for (std::size_t i = 0; i < n; ++i)
      colours[i] = mix(colours[i], outlier_grey, (*outlier)[static_cast<Eigen::Index>(i)]);
  return colours;
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

/// Whether confirmed vertices are white; "known" has a name of its own for them.
bool whitens_confirmed(Colouring colouring) {
  return colouring == Colouring::stiffness || colouring == Colouring::doubt || colouring == Colouring::confidence;
}

Legend legend_of_colours(const ShapeView& shown, Colouring colouring) {
  switch (colouring) {
    case Colouring::vertex_hue: {
      Legend legend{
          "0", "", figure_text("%.0f", static_cast<double>(shown.the_template().topology->vertices() - 1)), {}, {}};
      for (int i = 0; i <= 12; ++i) legend.colours.push_back(hsv_to_rgb(static_cast<float>(i) / 12.5f, 0.4f, 1));
      return legend;
    }
    case Colouring::edge_stretch:
      return {"0.5\xc3\x97", "1\xc3\x97", "2\xc3\x97", diverging(), {}};
    case Colouring::moved:
      return {"0 mm", "", figure_text("%.0f mm", moved_scale_mm(shown)), rising(), {}};
    case Colouring::stiffness:
      return {"0 soft", "", "stiff " + figure_text("%.1f\xc3\x97", stiffness_scale(shown)), rising(), {}};
    case Colouring::regions: {
      Legend legend{"", "", "", {no_region}, {"no region"}};
      for (const Region& region : shown.paint().regions->list) {
        legend.colours.push_back(rgb_of(region.colour));
        legend.names.push_back(region.name);
      }
      return legend;
    }
    case Colouring::known:
      return {
          "", "", "", {{1, 1, 1}, decided, left_open}, {"confirmed", "decided by hand, fit or snap", "not known yet"}};
    case Colouring::doubt:
      if (!shown.shape.doubt_mm) return {"", "", "", {no_region}, {"not known: a fit to a label map tells it"}};
      return {"0 mm", "", "\xe2\x89\xa5 " + figure_text("%.3g mm", doubt_scale_mm(shown)), doubt_scale(), {}};
    case Colouring::confidence:
      return {"no edge seen", "", "clear edge", confidence_scale()};
    case Colouring::quality:
      return {"flat", "", "equilateral", quality_scale(), {}};
  }
  return {};
}

}  // namespace

const char* colouring_title(Colouring colouring) {
  static constexpr std::array titles{"Hue of the vertex",
                                     "Stretch of edges",
                                     "Moved",
                                     "Stiffness",
                                     "Regions",
                                     "Shape of triangles",
                                     "Known",
                                     "Doubt",
                                     "Confidence of the snap"};
  return titles[static_cast<std::size_t>(colouring)];
}

Legend colouring_legend(const ShapeView& shown, Colouring colouring) {
  Legend legend = legend_of_colours(shown, colouring);
  const auto& outlier = shown.shape.outlier;
  legend.has_outliers = outlier && outlier->maxCoeff() > 0;
  const auto& confirmed = shown.shape.confirmed;
  legend.has_confirmed = whitens_confirmed(colouring) && confirmed && confirmed->maxCoeff() > 0;
  return legend;
}

}  // namespace homolog

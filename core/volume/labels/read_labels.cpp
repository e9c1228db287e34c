#include "core/volume/labels/read_labels.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/base/text/listed.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

/// The first finite value that is no whole number, up to what rescaling by 32-bit floats leaves.
std::optional<float> first_soft(std::span<const float> values) {
  constexpr float exactly = 1e-3f;
  const auto found = std::find_if(values.begin(), values.end(), [](float value) {
    return std::isfinite(value) && std::abs(value - std::rint(value)) > exactly;
  });
  if (found == values.end()) return {};
  return *found;
}

/// In which layers each label lies.
std::map<int, std::vector<std::size_t>> layers_of_values(std::span<const Volume* const> layers) {
  std::map<int, std::vector<std::size_t>> found;
  for (std::size_t layer = 0; layer < layers.size(); ++layer)
    for (const auto& [label, voxels] : labels_of(*layers[layer])) found[label].push_back(layer);
  return found;
}

/// "label 1 in layer 0, label 2 in layer 1", the first of them.
std::string layer_words(const Segmentation& segmentation) {
  constexpr std::size_t most = 8;
  std::vector<std::string> words;
  for (const Segment& segment : segmentation.segments) {
    if (words.size() == most) {
      words.push_back("…");
      break;
    }
    words.push_back(label_words(segment) + " in layer " + std::to_string(segment.layer));
  }
  return words.empty() ? "without labels" : listed(words, ", ");
}

template <class T>
bool has_any_label(T voxel) {
  return rounded_label(static_cast<double>(voxel)) != 0;
}

/// Sets the voxels that have a label in `from`: this one, or any where none is given.
void put_over(const Volume& from, std::optional<int> label, Volume& to) {
  std::visit(
      [&]<class T>(std::vector<T>& voxels) {
        const auto& source = std::get<std::vector<T>>(from.data);
        for (std::size_t i = 0; i < voxels.size(); ++i) {
          const int value = rounded_label(static_cast<double>(source[i]));
          if (label ? value == *label : value != 0) voxels[i] = source[i];
        }
      },
      to.data);
  to.range_min = std::min(to.range_min, from.range_min);
  to.range_max = std::max(to.range_max, from.range_max);
}

bool overlap(const Volume& a, const Volume& b) {
  return std::visit(
      [&]<class T>(const std::vector<T>& voxels) {
        const auto& others = std::get<std::vector<T>>(b.data);
        for (std::size_t i = 0; i < voxels.size(); ++i)
          if (has_any_label(voxels[i]) && has_any_label(others[i])) return true;
        return false;
      },
      a.data);
}

/// The "frames" of a volume, each as one of its own.
std::vector<Volume> frames_of(const Volume& volume) {
  std::vector<Volume> result;
  const std::size_t voxels = volume.geometry.voxels();
  for (int frame = 0; frame < volume.frames; ++frame) {
    Volume& one = result.emplace_back();
    one.geometry = volume.geometry;
    std::visit(
        [&](const auto& all) {
          const auto begin = all.begin() + static_cast<std::ptrdiff_t>(voxels * static_cast<std::size_t>(frame));
          std::decay_t<decltype(all)> own(begin, begin + static_cast<std::ptrdiff_t>(voxels));
          const auto [low, high] = std::minmax_element(own.begin(), own.end());
          one.range_min = static_cast<double>(*low);
          one.range_max = static_cast<double>(*high);
          one.data = std::move(own);
        },
        volume.data);
  }
  return result;
}

}  // namespace

void warn_of_soft_labels(const fs::path& path, const Volume& labels, int frame, std::vector<std::string>& warnings) {
  const auto* values = std::get_if<std::vector<float>>(&labels.data);
  if (values == nullptr) return;
  const std::size_t count = labels.geometry.voxels();
  const auto soft = first_soft(std::span(*values).subspan(count * static_cast<std::size_t>(frame), count));
  if (!soft) return;
  char number[32];
  std::snprintf(number, sizeof number, "%.4g", static_cast<double>(*soft));
  warnings.push_back(path.string() + ": holds values that are no whole numbers, as " + number +
                     ", which are rounded to the nearest label; save it as a label map of whole numbers, or threshold "
                     "it where its boundary is meant to be");
}

Result<VolumeRead> read_labels(const fs::path& path, const VolumeReadOptions& options) {
  auto read = read_volume(path, options);
  if (!read) return read;
  const std::size_t before = read->warnings.size();
  for (int frame = 0; frame < read->volume.frames && read->warnings.size() == before; ++frame)
    warn_of_soft_labels(path, read->volume, frame, read->warnings);
  return read;
}

void take_layers(const fs::path& path, VolumeRead& read) {
  std::vector<Volume> layers = frames_of(read.volume);
  read.volume = std::move(layers.front());
  layers.erase(layers.begin());
  read.other_layers = std::move(layers);
  const std::string count = std::to_string(read.other_layers.size() + 1);
  const auto all = read.layers();
  for (const auto& [value, in] : layers_of_values(all))
    for (const std::size_t layer : in) read.segmentation.add({.name = {}, .value = value, .layer = layer});
  std::set<int> values;
  const auto& segments = read.segmentation.segments;
  bool apart = std::all_of(segments.begin(), segments.end(),
                           [&](const Segment& segment) { return values.insert(segment.value).second; });
  Volume united = apart ? read.volume : Volume();
  for (std::size_t layer = 1; layer < all.size() && apart; ++layer) {
    apart = !overlap(united, *all[layer]);
    if (apart) put_over(*all[layer], {}, united);
  }
  if (apart) {
    read.volume = std::move(united);
    read.other_layers.clear();
    read.about_layers = path.string() + ": holds its segments in " + count +
                        " layers that nowhere overlap; they are read as one label map";
    return;
  }
  read.about_layers =
      path.string() + ": holds its segments in " + count + " layers, not frames: " + layer_words(read.segmentation) +
      "; what takes one layer takes the first, unless you choose another (--label; in the window: Case, Layer)";
}

Result<std::vector<Segment>> choose_segments(const fs::path& path, const std::string& asked, VolumeRead& read) {
  std::vector<Segment> wanted;
  if (!asked.empty()) {
    auto found = asked_segments(asked, read.segmentation);
    if (!found) return fail(path.string(), found.error().what);
    wanted = std::move(*found);
  }
  if (read.other_layers.empty()) return wanted;
  const auto all = read.layers();
  if (wanted.empty()) {
    for (const auto& [value, in] : layers_of_values(all))
      for (const std::size_t layer : in) {
        const Segment* known = read.segmentation.find(value, layer);
        wanted.push_back(known ? *known : Segment{.name = {}, .value = value, .layer = layer});
      }
    if (wanted.empty()) return wanted;  // said where the label is looked for
    if (wanted.size() > 1 && wanted.front().value != wanted.back().value)
      return fail(path.string(), "holds its segments in layers (" + layer_words(read.segmentation) +
                                     "); choose one of them by its label or its name");
    if (wanted.size() > 1)
      if (auto told = asked_segments(std::to_string(wanted.front().value), read.segmentation); !told)
        return fail(path.string(), told.error().what);
  }
  const auto is_known = [&](const Segment& s) { return read.segmentation.find(s.value, s.layer) != nullptr; };
  if (std::none_of(wanted.begin(), wanted.end(), is_known)) return wanted;  // said where the label is looked for
  Volume chosen = *all[wanted.front().layer];
  if (wanted.size() > 1) {
    for (const Segment& segment : wanted)
      if (!same_grid(all[segment.layer]->geometry, chosen.geometry))
        return fail(path.string(), "keeps " + label_words(wanted.front()) + " and " + label_words(segment) +
                                       " on grids of their own; name one of them, or resample them to one grid");
    std::visit([](auto& voxels) { std::fill(voxels.begin(), voxels.end(), 0); }, chosen.data);
    for (const Segment& segment : wanted) put_over(*all[segment.layer], segment.value, chosen);
  }
  read.volume = std::move(chosen);
  read.other_layers.clear();
  // Values of other layers are not those of this label map.
  std::erase_if(read.segmentation.segments, [&](const Segment& segment) {
    const bool is_wanted = std::ranges::any_of(
        wanted, [&](const Segment& one) { return one.value == segment.value && one.layer == segment.layer; });
    return !is_wanted && (wanted.size() > 1 || segment.layer != wanted.front().layer);
  });
  return wanted;
}

int unite_segments(Volume& volume, std::span<const Segment> segments, int frame) {
  const auto held = labels_of(volume, frame);
  std::vector<int> there;
  for (const Segment& segment : segments)
    if (held.contains(segment.value)) there.push_back(segment.value);
  unite_labels(volume, there);
  return there.empty() ? segments.front().value : there.front();
}

}  // namespace homolog

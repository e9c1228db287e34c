#include "app/verbs/read_image.h"

#include <algorithm>
#include <charconv>
#include <iterator>

#include "core/measure/compare.h"
#include "core/volume/read_labels.h"

namespace homolog {

namespace {

/// "1,2" as numbers above 0; empty where it is something else.
std::vector<int> parsed_labels(const std::string& text) {
  std::vector<int> labels;
  const char *at = text.data(), *const end = at + text.size();
  while (true) {
    int label = 0;
    const auto [after, error] = std::from_chars(at, end, label);
    if (error != std::errc() || label <= 0) return {};
    labels.push_back(label);
    if (after == end) return labels;
    if (*after != ',') return {};
    at = after + 1;
  }
}

}  // namespace

Result<VolumeRead> read_image(const std::filesystem::path& path, int frame, Progress& progress) {
  VolumeReadOptions reading;
  reading.progress = &progress;
  auto read = read_volume(path, reading);
  if (read && frame >= read->volume.frames)
    return fail(path.string(),
                "has " + std::to_string(read->volume.frames) + " frames, counted from 0; choose --frame among them");
  return read;
}

CLI::Option* add_label_option(CLI::App& verb, std::vector<int>& labels, const std::string& help) {
  return verb
      .add_option_function<std::string>(
          "--label",
          [&labels](const std::string& text) {
            labels = parsed_labels(text);
            if (labels.empty())
              throw CLI::ValidationError("--label", "needs a number above 0, or several as in 1,2; got " + text);
          },
          help)
      ->type_name("N[,N...]");
}

CLI::Option* add_ball_option(CLI::App& verb, const std::string& name, std::optional<double>& radius_mm,
                             const std::string& help) {
  return verb
      .add_option_function<double>(
          name, [&radius_mm](const double& radius) { radius_mm = radius; },
          help + "; without it 0.00625 of the organ's size")
      ->check(CLI::NonNegativeNumber);
}

std::string MaskRead::named(std::string sentence) const {
  if (from.size() < 2) return sentence;
  const std::string one = "label " + std::to_string(label);
  std::string all = "label ";
  for (std::size_t k = 0; k < from.size(); ++k) all += (k > 0 ? "+" : "") + std::to_string(from[k]);
  for (std::size_t at = sentence.find(one + " "); at != std::string::npos; at = sentence.find(one + " ", at + 1))
    sentence.replace(at, one.size(), all);
  return sentence;
}

std::vector<std::string> MaskRead::named(std::vector<std::string> sentences) const {
  for (std::string& sentence : sentences) sentence = named(std::move(sentence));
  return sentences;
}

Result<MaskRead> read_mask(const std::filesystem::path& path, const std::vector<int>& labels, int frame,
                           Progress& progress) {
  auto read = read_image(path, frame, progress);
  if (!read) return fail(read.error());
  if (auto chosen = choose_layer(path, labels, *read); !chosen) return fail(chosen.error());
  warn_of_soft_labels(path, read->volume, frame, read->warnings);
  if (labels.size() > 1) {  // one that does not occur adds nothing: most kidneys have no tumour
    const auto held = labels_of(read->volume, frame);
    std::vector<int> there;
    std::copy_if(labels.begin(), labels.end(), std::back_inserter(there), [&](int l) { return held.contains(l); });
    unite_labels(read->volume, there);
    const int label = there.empty() ? labels.front() : there.front();
    return MaskRead{std::move(*read), label, labels};
  }
  const auto chosen = !labels.empty() ? Result<int>(labels.front()) : only_label(read->volume, frame);
  if (!chosen) return fail(path.string(), chosen.error().what + " by --label");
  return MaskRead{std::move(*read), *chosen, {*chosen}};
}

}  // namespace homolog

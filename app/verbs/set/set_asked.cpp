#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "app/verbs/set/set_cases.h"
#include "app/verbs/set/set_making.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"

// Which structures of its maps a template set is asked for.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The labels between the commas.
std::vector<std::string> labels_between_commas(const std::string& labels) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  while (from <= labels.size()) {
    const std::size_t to = std::min(labels.find(',', from), labels.size());
    parts.emplace_back(trimmed(std::string_view(labels).substr(from, to - from)));
    from = to + 1;
  }
  return parts;
}

/// Labels that are asked for, and which of them a map so far had; why not, of the first.
struct AskedLabels {
  std::vector<std::string> parts;
  std::vector<char> found;
  std::vector<std::optional<Error>> why_not;
};

/// Those that the map has. Errors: that it has none is none.
std::vector<Segment> named_in(const VolumeRead& read, const std::string& labels, const fs::path& map,
                              AskedLabels& asked) {
  std::vector<Segment> segments;
  const auto add = [&](const std::vector<Segment>& more) {  // two names may mean one label
    for (const Segment& segment : more) {
      const auto same = [&](const Segment& s) { return s.value == segment.value && s.layer == segment.layer; };
      if (std::ranges::none_of(segments, same)) segments.push_back(segment);
    }
  };
  if (const auto whole = asked_segments(labels, read.segmentation)) {
    std::ranges::fill(asked.found, 1);
    add(*whole);
    return segments;
  }
  for (std::size_t k = 0; k < asked.parts.size(); ++k) {
    auto one = asked_segments(asked.parts[k], read.segmentation);
    if (one) add(*one);
    if (one) asked.found[k] = 1;
    if (!one && !asked.why_not[k]) asked.why_not[k] = Error{map.string(), one.error().what};
  }
  return segments;
}

std::vector<Segment> all_of(const VolumeRead& read) {
  std::vector<Segment> segments = read.segmentation.segments;
  for (const auto& [value, voxels] : labels_of(read.volume, 0))
    if (value != 0 && read.segmentation.find(value) == nullptr) segments.push_back({{}, value});
  return segments;
}

/// Takes out the segments whose name others have too, as the set would give it, and tells of each such name.
std::vector<std::string> take_doubled(std::vector<Segment>& segments, bool has_layers) {
  std::map<std::string, std::vector<Segment>> by_name;
  const auto key = [](const Segment& segment) { return lower_case(file_name_of_structure(name_in_set(segment))); };
  for (const Segment& segment : segments) by_name[key(segment)].push_back(segment);
  std::vector<std::string> words;
  for (const auto& [name, doubled] : by_name) {
    if (doubled.size() < 2) continue;
    std::vector<std::string> labels;
    for (const Segment& segment : doubled) labels.push_back(value_and_layer(segment, has_layers));
    words.push_back("has " + std::to_string(doubled.size()) + " structures named \"" + name_in_set(doubled.front()) +
                    "\", the labels " + listed(labels, " and "));
  }
  std::erase_if(segments, [&](const Segment& segment) { return by_name[key(segment)].size() > 1; });
  return words;
}

}  // namespace

void add_structure_options(CLI::App& verb, SetJob& job) {
  auto* labels = verb.add_option("--labels", job.labels, "Which structures, by name or number: liver,spleen,3");
  verb.add_flag("--all", job.all, "All structures of the maps")->excludes(labels);
  verb.add_option("--vertices", job.vertices, "How many vertices each template has")
      ->check(CLI::Range(100, 200000))
      ->capture_default_str();
}

CLI::Option* is_name_of_set(CLI::Option* output) {
  return output->check([](const std::string& text) {
    return is_template_set(text) ? std::string() : text + " is no name of a set; use NAME.set.json";
  });
}

std::string name_in_set(const Segment& segment) {
  return segment.name.empty() ? "label " + std::to_string(segment.value) : segment.name;
}

Result<std::vector<std::vector<Segment>>> structures_asked(const SetJob& job, SetInMaking& making, Progress& progress) {
  AskedLabels labels;
  labels.parts = labels_between_commas(job.labels);
  labels.found.resize(labels.parts.size());
  labels.why_not.resize(labels.parts.size());
  std::vector<std::vector<Segment>> asked;
  std::set<fs::path> met;
  for (const fs::path& map : job.maps) {
    std::error_code ignored;
    if (!met.insert(fs::weakly_canonical(map, ignored)).second)
      return fail(map.string(), "is given twice, and would count as two subjects; name each map once");
    const auto subject = read_subject(map, std::nullopt, progress, false);
    if (!subject) return fail(subject.error());
    const VolumeRead& read = subject->read;
    making.warnings.insert(making.warnings.end(), read.warnings.begin(), read.warnings.end());
    for (const Segment& segment : all_of(read)) making.highest_value = std::max(making.highest_value, segment.value);
    asked.push_back(job.all ? all_of(read) : named_in(read, job.labels, map, labels));
    if (job.all && asked.back().empty()) return fail(map.string(), "holds no label; give a label map");
    for (const std::string& what : take_doubled(asked.back(), !read.other_layers.empty())) {
      if (!job.all) return fail(map.string(), what + "; name them apart");
      making.warnings.push_back(map.string() + ": " + what + "; they are left out; give one of them another name");
    }
    if (job.all && asked.back().empty())
      return fail(map.string(), "has no structure with a name of its own; give each another name");
  }
  for (std::size_t k = 0; k < labels.parts.size() && !job.all; ++k)
    if (labels.found[k] == 0) return fail(*labels.why_not[k]);
  return asked;
}

}  // namespace homolog

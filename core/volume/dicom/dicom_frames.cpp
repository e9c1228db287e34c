#include "core/volume/dicom/dicom_frames.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace homolog {
namespace fs = std::filesystem;

namespace {

using Places = std::vector<std::vector<DicomPlaneSource>>;

/// Whether all planes have the time, and whether any has.
struct Given {
  bool all = true, any = false;
};

Given given(const Places& places, std::size_t clock) {
  Given result;
  for (const auto& place : places)
    for (const DicomPlaneSource& source : place) {
      result.all = result.all && source.times[clock];
      result.any = result.any || source.times[clock];
    }
  return result;
}

/// Calls `change` with each plane's time by the clock, which all planes have.
template <class Change>
void for_each_time(Places& places, std::size_t clock, const Change& change) {
  for (auto& place : places)
    for (DicomPlaneSource& source : place) change(*source.times[clock]);
}

/// Times of the day that pass midnight go on behind it if dates do not tell: the day is cut in its longest pause,
/// of more than half a day. Whether they do.
bool continue_past_midnight(Places& places, std::size_t clock) {
  std::vector<double> times;
  for_each_time(places, clock, [&](double time) { times.push_back(time); });
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  if (*first >= day_ms && std::floor(*first / day_ms) != std::floor(*last / day_ms)) return false;  // the dates tell
  for (double& time : times) time = std::fmod(time, day_ms);
  std::sort(times.begin(), times.end());
  const double earliest = times.front();
  double begin = earliest;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (times[i] - times[i - 1] > day_ms / 2) begin = times[i];
  for_each_time(places, clock, [&](double& time) {
    time = std::fmod(time, day_ms);
    if (time < begin) time += day_ms;
  });
  return begin > earliest;
}

/// The clocks that can order the planes: those that all planes have. A time that some lack says nothing of these.
std::vector<std::size_t> whole_clocks(const fs::path& path, Places& places, std::vector<std::string>& warnings) {
  std::vector<std::size_t> clocks;
  for (std::size_t clock = 0; clock < dicom_clocks; ++clock) {
    const auto which = static_cast<DicomClock>(clock);
    const Given here = given(places, clock);
    if (here.all) {
      clocks.push_back(clock);
      const bool of_day = which == DicomClock::acquired || which == DicomClock::made;
      if (of_day && continue_past_midnight(places, clock) && which == DicomClock::acquired)
        warnings.push_back(path.string() +
                           ": its acquisition times pass midnight; frames after it follow those before");
    } else if (here.any && which < DicomClock::acquired) {
      warnings.push_back(path.string() + ": only some of its slices give a " + name_of(which) +
                         ", so that it does not order the frames");
    }
  }
  return clocks;
}

/// The first of the clocks by which two planes differ.
std::optional<DicomClock> clock_between(const std::vector<std::size_t>& clocks, const DicomPlaneSource& a,
                                        const DicomPlaneSource& b) {
  for (const std::size_t clock : clocks)
    if (a.times[clock] != b.times[clock]) return static_cast<DicomClock>(clock);
  return {};
}

/// Two planes of one place that are no frames of one cine.
class TwoPlanes {
 public:
  TwoPlanes(const fs::path& path, const std::vector<DicomHeader>& headers, const DicomPlaneSource& a,
            const DicomPlaneSource& b)
      : path_(path), a_(headers[a.file]), b_(headers[b.file]), plane_a_(*a.plane), plane_b_(*b.plane) {}

  /// "has two slices at one place that differ in their image types (…)".
  tl::unexpected<Error> differ_in(const std::string& what, const std::string& a, const std::string& b) const {
    const bool readable = std::all_of(a.begin(), a.end(), [](char c) { return c >= ' '; }) && a.size() < 80;
    return fail(path_.string(), "holds several images of one place, of different " + what +
                                    (readable ? " (" + a + " and " + b + ")" : "") + ": " + names() +
                                    "; keep the slices of one of them");
  }

  /// Errors: what differs is no time.
  Result<void> check_settings() const {
    if (plane_a_.b_value != plane_b_.b_value)
      return differ_in("b-values", number(plane_a_.b_value), number(plane_b_.b_value));
    for (std::size_t s = 0; s < a_.settings.size(); ++s)
      if (a_.settings[s] != b_.settings[s])
        return differ_in(a_.settings[s].name, a_.settings[s].value, b_.settings[s].value);
    return {};
  }

  /// The same where no clock tells the two apart; what is left then are their numbers.
  Result<void> check_without_times() const {
    if (a_.acquisition_number != b_.acquisition_number)
      return differ_in("acquisitions", "number " + a_.acquisition_number, "number " + b_.acquisition_number);
    if (&a_ == &b_ && !a_.planes_are_frames && a_.frame_ms <= 0) return same_file();
    if (&a_ != &b_ && a_.instance_number == b_.instance_number)
      return fail(path_.string(), "holds several slices of one place, and nothing tells them apart: " + names() +
                                      "; keep one of them, or copy the series again");
    return {};
  }

 private:
  /// Two planes of one file, of which it gives no time.
  tl::unexpected<Error> same_file() const {
    const bool one_place = std::all_of(a_.planes.begin(), a_.planes.end(), [&](const DicomPlane& plane) {
      return plane.position_mm == a_.planes.front().position_mm;
    });
    if (one_place)
      return fail(a_.path.string(), "gives one position for its " + std::to_string(a_.planes.size()) +
                                        " planes, and neither a time nor a distance between them; export it as single "
                                        "slices");
    return fail(a_.path.string(),
                "holds several planes of one place, and no time tells them apart; export the scan, or "
                "one segment, as a volume of its own");
  }
  std::string names() const { return a_.path.filename().string() + " and " + b_.path.filename().string(); }
  static std::string number(std::optional<double> value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value.value_or(0));
    return value ? text : "none";
  }

  const fs::path& path_;
  const DicomHeader &a_, &b_;
  const DicomPlane &plane_a_, &plane_b_;
};

}  // namespace

Result<void> order_frames(const fs::path& path, const std::vector<DicomHeader>& headers, Places& places,
                          std::vector<std::string>& warnings) {
  if (places.front().size() < 2) return {};
  const auto clocks = whole_clocks(path, places, warnings);
  bool by_number = false;
  for (auto& place : places) {
    std::stable_sort(place.begin(), place.end(), [&](const DicomPlaneSource& a, const DicomPlaneSource& b) {
      if (const auto clock = clock_between(clocks, a, b)) {
        const auto c = static_cast<std::size_t>(*clock);
        return a.times[c] < b.times[c];
      }
      if (headers[a.file].instance_number != headers[b.file].instance_number)
        return headers[a.file].instance_number < headers[b.file].instance_number;
      return a.plane_in_file < b.plane_in_file;
    });
    for (std::size_t p = 1; p < place.size(); ++p) {
      const auto clock = clock_between(clocks, place[p - 1], place[p]);
      // Two echoes are made at different moments, too; the clocks before those are told only of frames.
      if (clock && *clock < DicomClock::acquired) continue;
      const TwoPlanes two(path, headers, place[p - 1], place[p]);
      if (auto alike = two.check_settings(); !alike) return alike;
      if (clock) continue;
      if (auto frames = two.check_without_times(); !frames) return frames;
      by_number = by_number || place[p - 1].file != place[p].file;
    }
  }
  if (by_number)
    warnings.push_back(
        path.string() +
        ": holds several slices of one place that give no times; they are taken for frames, in the order "
        "of their numbers");
  return {};
}

double seconds_between_frames(const std::vector<DicomHeader>& headers, const Places& places) {
  if (headers.front().frame_ms > 0) return headers.front().frame_ms / 1000;
  const auto& place = places.front();
  for (const DicomClock clock :
       {DicomClock::trigger, DicomClock::offset, DicomClock::reference, DicomClock::acquired}) {
    const auto c = static_cast<std::size_t>(clock);
    const auto follows = [c](const DicomPlaneSource& a, const DicomPlaneSource& b) {
      return !a.times[c] || !b.times[c] || *a.times[c] > *b.times[c];
    };
    if (std::adjacent_find(place.begin(), place.end(), follows) != place.end()) continue;
    if (const double ms = *place[1].times[c] - *place[0].times[c]; ms > 1) return ms / 1000;
  }
  return 0;
}

}  // namespace homolog

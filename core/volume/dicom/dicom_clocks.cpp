#include "core/volume/dicom/dicom_clocks.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <string_view>

namespace homolog {
namespace {

namespace tag {
constexpr DicomTag acquisition_date = 0x00080022, content_date = 0x00080023, acquisition_date_time = 0x0008002a,
                   acquisition_time = 0x00080032, content_time = 0x00080033, trigger_time = 0x00181060,
                   frame_acquisition = 0x00189074, cardiac_group = 0x00189118, frame_reference_date_time = 0x00189151,
                   temporal_position = 0x00200100, content_group = 0x00209111, temporal_index = 0x00209128,
                   trigger_delay = 0x00209153, heart_phase = 0x00209241, breath_phase = 0x00209245,
                   breath_group = 0x00209253, temporal_group = 0x00209310, temporal_offset = 0x0020930d,
                   frame_reference_time = 0x00541300;
}  // namespace tag

/// The number that some digits are; nothing where they are none.
std::optional<int> digits(std::string_view text, std::size_t begin, std::size_t count) {
  if (begin + count > text.size()) return {};
  int number = 0;
  const char *const first = text.data() + begin, *const last = first + count;
  const auto [rest, error] = std::from_chars(first, last, number);
  if (error != std::errc() || rest != last || number < 0) return {};
  return number;
}

/// ms since 1800 where there is a date, else of the day; nothing without a time.
std::optional<double> moment(const std::string& date, const std::string& time) {
  const auto ms = ms_of_day(time);
  if (!ms) return {};
  return days_of_date(date).value_or(0) * day_ms + *ms;
}

/// The same of a date with its time (DT), whose time zone does not matter within a series.
std::optional<double> moment(const std::string& date_time) {
  constexpr std::size_t date_digits = 8;
  if (date_time.size() <= date_digits) return {};
  const auto zone = date_time.find_first_of("+-", date_digits);
  return moment(date_time.substr(0, date_digits),
                date_time.substr(date_digits, zone == std::string::npos ? zone : zone - date_digits));
}

std::optional<double> first_of(std::initializer_list<std::optional<double>> several) {
  for (const auto& one : several)
    if (one) return one;
  return {};
}

}  // namespace

const char* name_of(DicomClock clock) {
  constexpr std::array<const char*, dicom_clocks> names{
      "temporal position",    "trigger time",     "phase",       "temporal position's time",
      "frame reference time", "acquisition time", "content time"};
  return names[static_cast<std::size_t>(clock)];
}

std::optional<double> ms_of_day(std::string text) {
  std::erase(text, ':');  // as files before DICOM wrote it
  const auto point = text.find('.');
  const std::string_view whole = std::string_view(text).substr(0, point);
  if (whole.size() != 2 && whole.size() != 4 && whole.size() != 6) return {};
  const auto hours = digits(whole, 0, 2);
  const auto minutes = whole.size() > 2 ? digits(whole, 2, 2) : 0, seconds = whole.size() > 4 ? digits(whole, 4, 2) : 0;
  if (!hours || !minutes || !seconds || *hours > 23 || *minutes > 59 || *seconds > 60) return {};
  double fraction = 0;
  if (point != std::string::npos) {
    const std::string part = "0" + text.substr(point);
    const auto [rest, error] = std::from_chars(part.data(), part.data() + part.size(), fraction);
    if (error != std::errc() || rest != part.data() + part.size()) return {};
  }
  return 1000 * (3600.0 * *hours + 60.0 * *minutes + *seconds + fraction);
}

std::optional<double> days_of_date(std::string text) {
  using namespace std::chrono;
  std::erase(text, '.');
  if (text.size() != 8) return {};
  const auto y = digits(text, 0, 4), m = digits(text, 4, 2), d = digits(text, 6, 2);
  if (!y || !m || !d || *y <= 1800) return {};
  const year_month_day date(year(*y), month(static_cast<unsigned>(*m)), day(static_cast<unsigned>(*d)));
  if (!date.ok()) return {};
  return static_cast<double>((sys_days(date) - sys_days(year(1800) / 1 / 1)).count());
}

DicomTimes times_of(const DicomItem& data, std::size_t plane, bool big_endian) {
  const DicomItem& content = aspect_of(data, plane, tag::content_group);
  const auto binary = [&](DicomTag group, DicomTag wanted) {
    return binary_number_of(aspect_of(data, plane, group), wanted, big_endian);
  };
  DicomTimes times;
  const auto at = [&times](DicomClock clock) -> std::optional<double>& {
    return times[static_cast<std::size_t>(clock)];
  };
  at(DicomClock::index) =
      first_of({binary(tag::content_group, tag::temporal_index), number_of(data, tag::temporal_position)});
  at(DicomClock::trigger) =
      first_of({binary(tag::cardiac_group, tag::trigger_delay), number_of(data, tag::trigger_time)});
  at(DicomClock::phase) =
      first_of({binary(tag::cardiac_group, tag::heart_phase), binary(tag::breath_group, tag::breath_phase)});
  if (const auto seconds = binary(tag::temporal_group, tag::temporal_offset)) at(DicomClock::offset) = 1000 * *seconds;
  at(DicomClock::reference) =
      first_of({number_of(data, tag::frame_reference_time), moment(text_of(content, tag::frame_reference_date_time))});
  at(DicomClock::acquired) =
      first_of({moment(text_of(content, tag::frame_acquisition)), moment(text_of(data, tag::acquisition_date_time)),
                moment(text_of(data, tag::acquisition_date), text_of(data, tag::acquisition_time))});
  at(DicomClock::made) = moment(text_of(data, tag::content_date), text_of(data, tag::content_time));
  return times;
}

}  // namespace homolog

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "core/volume/dicom/dicom_set.h"

namespace homolog {

/// The attributes that tell when a plane was taken, or as which of several; the first one is believed first.
enum class DicomClock {
  index,      ///< temporal position, counted
  trigger,    ///< ms since the R wave
  phase,      ///< percent of a heart beat or of a breath
  offset,     ///< ms since the first temporal position
  reference,  ///< ms, of the frame within the series (PET)
  acquired,   ///< ms of the day, or with its date ms since 1800
  made        ///< the same, of the image's making: several images of one moment differ in it
};
inline constexpr std::size_t dicom_clocks = 7;

/// The value of each clock for a plane; 0 is a time. None where the file does not give it.
using DicomTimes = std::array<std::optional<double>, dicom_clocks>;

/// "trigger time", as sentences name the clock.
const char* name_of(DicomClock clock);

inline constexpr double day_ms = 86'400'000;

/// A time of the day (TM) in ms [DICOM PS3.5 §6.2]; nothing where the text is none.
std::optional<double> ms_of_day(std::string text);

/// Days since 1800 of a date (DA); nothing where the text is none.
std::optional<double> days_of_date(std::string text);

/// The times of a plane, from its functional groups or else from the file.
DicomTimes times_of(const DicomItem& data, std::size_t plane, bool big_endian);

}  // namespace homolog

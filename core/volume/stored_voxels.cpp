#include "core/volume/stored_voxels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace homolog {
namespace {

template <class T>
constexpr bool kept_as_is = std::is_same_v<T, std::uint8_t> || std::is_same_v<T, std::int16_t> ||
                            std::is_same_v<T, std::uint16_t> || std::is_same_v<T, float>;

struct Range {
  double min = 0, max = 0;
};

template <class T>
Range integer_range(const std::vector<T>& values) {
  if (values.empty()) return {};
  T low = values[0], high = values[0];
  for (const T v : values) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  return {static_cast<double>(low), static_cast<double>(high)};
}

template <class T>
Range finite_range_slowly(const std::vector<T>& values) {
  T low = std::numeric_limits<T>::infinity(), high = -low;
  for (const T v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  if (low > high) return {};
  return {static_cast<double>(low), static_cast<double>(high)};
}

/// Eight independent lanes, since a single running minimum of floats is not vectorised; NaN fails both comparisons.
template <class T>
Range finite_range(const std::vector<T>& values) {
  constexpr std::size_t lanes = 8;
  std::array<T, lanes> low, high;
  low.fill(std::numeric_limits<T>::infinity());
  high.fill(-std::numeric_limits<T>::infinity());
  const std::size_t whole = values.size() / lanes * lanes;
  for (std::size_t i = 0; i < whole; i += lanes)
    for (std::size_t l = 0; l < lanes; ++l) {
      const T v = values[i + l];
      low[l] = v < low[l] ? v : low[l];
      high[l] = v > high[l] ? v : high[l];
    }
  for (std::size_t i = whole; i < values.size(); ++i) {
    low[0] = values[i] < low[0] ? values[i] : low[0];
    high[0] = values[i] > high[0] ? values[i] : high[0];
  }
  const T least = *std::min_element(low.begin(), low.end()), most = *std::max_element(high.begin(), high.end());
  if (!std::isfinite(least) || !std::isfinite(most)) return finite_range_slowly(values);
  return {static_cast<double>(least), static_cast<double>(most)};
}

template <class T>
Range range_of(const std::vector<T>& values) {
  if constexpr (std::is_integral_v<T>)
    return integer_range(values);
  else
    return finite_range(values);
}

template <class To, class From>
std::vector<To> rescaled(const std::vector<From>& values, const Rescale& rescale) {
  std::vector<To> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    result[i] = static_cast<To>(rescale.slope * static_cast<double>(values[i]) + rescale.intercept);
  return result;
}

template <class To>
bool holds(const Range& range) {
  return range.min >= std::numeric_limits<To>::min() && range.max <= std::numeric_limits<To>::max();
}

template <class T>
void keep(std::vector<T> values, Volume& volume) {
  const Range range = range_of(values);
  volume.range_min = range.min;
  volume.range_max = range.max;
  volume.data = std::move(values);
}

template <class T>
Result<void> convert(const std::vector<T>& values, const Rescale& rescale, const std::string& subject, Volume& volume,
                     std::vector<std::string>& warnings) {
  const Range stored = range_of(values);
  const double a = rescale.slope * stored.min + rescale.intercept, b = rescale.slope * stored.max + rescale.intercept;
  const Range range{std::min(a, b), std::max(a, b)};
  const bool integers = std::is_integral_v<T> && rescale.slope == std::rint(rescale.slope) &&
                        rescale.intercept == std::rint(rescale.intercept);
  if (integers && holds<std::uint8_t>(range)) {
    keep(rescaled<std::uint8_t>(values, rescale), volume);
  } else if (integers && holds<std::int16_t>(range)) {
    keep(rescaled<std::int16_t>(values, rescale), volume);
  } else if (integers && holds<std::uint16_t>(range)) {
    keep(rescaled<std::uint16_t>(values, rescale), volume);
  } else {
    const double largest = std::max(std::abs(range.min), std::abs(range.max));
    if (!(largest <= static_cast<double>(std::numeric_limits<float>::max())))
      return fail(subject,
                  "holds values beyond 3.4e38, more than 32-bit floats can hold; rescale it and export it again");
    constexpr double exact_integers = 1 << std::numeric_limits<float>::digits;
    if (integers && largest > exact_integers)
      warnings.push_back(subject + ": has integers above 16,777,216; they are rounded to 32-bit floats");
    keep(rescaled<float>(values, rescale), volume);
  }
  return {};
}

}  // namespace

double bytes_while_reading(Scalar type, double voxels, bool rescaled) {
  const bool kept = type == Scalar::uint8 || type == Scalar::int16 || type == Scalar::uint16 || type == Scalar::float32;
  return voxels * (static_cast<double>(size_of(type)) + (kept && !rescaled ? 0.0 : 4.0));
}

StoredVoxels make_stored_voxels(Scalar type, std::size_t count) {
  return with_type(type, [count]<class T>(std::type_identity<T>) { return StoredVoxels(std::vector<T>(count)); });
}

std::span<std::byte> bytes_of(StoredVoxels& voxels) {
  return std::visit([](auto& values) { return std::as_writable_bytes(std::span(values)); }, voxels);
}

void reserve_voxels(StoredVoxels& voxels, std::size_t count) {
  std::visit([count](auto& values) { values.reserve(count); }, voxels);
}

std::span<std::byte> add_voxels(StoredVoxels& voxels, std::size_t count) {
  return std::visit(
      [count](auto& values) {
        const std::size_t before = values.size();
        values.resize(before + count);
        return std::as_writable_bytes(std::span(values).subspan(before));
      },
      voxels);
}

void swap_byte_order(StoredVoxels& voxels) {
  std::visit([](auto& values) { swap_byte_order<sizeof(values[0])>(std::as_writable_bytes(std::span(values))); },
             voxels);
}

Result<void> keep_voxels(StoredVoxels voxels, const Rescale& rescale, const std::string& subject, Volume& volume,
                         std::vector<std::string>& warnings) {
  return std::visit(
      [&](auto& values) -> Result<void> {
        using T = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (kept_as_is<T>) {
          if (rescale.identity()) {
            keep(std::move(values), volume);
            return {};
          }
        }
        return convert(values, rescale, subject, volume, warnings);
      },
      voxels);
}

}  // namespace homolog

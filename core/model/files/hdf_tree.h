#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// The tree that files of statismo and scalismo are made of: groups named by paths ("/model"), which hold text
/// attributes and datasets.
struct HdfTree {
  struct Dataset {
    std::vector<std::size_t> dims;  ///< row-major; empty for a single value
    std::variant<std::vector<float>, std::vector<std::int32_t>, std::string> values;
  };
  std::map<std::string, std::map<std::string, std::string>> groups;  ///< path → attributes
  std::map<std::string, Dataset> datasets;                           ///< datasets by path, "/model/mean"

  const std::vector<float>* floats(const std::string& path) const;
  const std::vector<std::int32_t>* integers(const std::string& path) const;
  /// Empty where absent.
  std::string text(const std::string& path) const;
  std::string attribute(const std::string& group, const std::string& name) const;
  /// Adds a group and those above it.
  std::map<std::string, std::string>& add_group(const std::string& path);
};

/// The parts of a file that are read. Everything else is left alone: a small file may link a few groups into a tree
/// without end, or claim texts and tables of any size.
struct HdfParts {
  std::vector<std::pair<std::string, std::string>> attributes;  ///< group and name, of texts
  std::vector<std::string> datasets;
  std::vector<std::string> numbered;  ///< "/a/b_": the datasets "/a/b_0", "/a/b_1", … up to the first that is absent
};

/// Calls `read_attribute(group, name)` and `read_dataset(path)` for all parts; the latter says whether it is there.
/// Ends with the first error.
template <class ReadAttribute, class ReadDataset>
Result<void> read_parts(const HdfParts& parts, const ReadAttribute& read_attribute, const ReadDataset& read_dataset) {
  for (const auto& [group, name] : parts.attributes)
    if (Result<void> done = read_attribute(group, name); !done) return done;
  for (const std::string& path : parts.datasets)
    if (Result<bool> done = read_dataset(path); !done) return fail(done.error());
  for (const std::string& start : parts.numbered)
    for (std::size_t k = 0;; ++k) {
      const Result<bool> there = read_dataset(start + std::to_string(k));
      if (!there) return fail(there.error());
      if (!*there) break;
    }
  return {};
}

/// How many bytes the values of all parts together may take: a file can name one table by several paths, and what is
/// packed in it may unfold.
constexpr std::uintmax_t most_value_bytes(std::uintmax_t file_bytes) {
  return (std::uintmax_t{16} << 20) + 32 * file_bytes;
}

/// HDF5 itself, by libhdf5 in a process of its own (hdf5_reader.h). Parts that are absent or of another kind are left
/// out; every number becomes float or int32. Errors: not HDF5, damaged, values that the file has no room for.
Result<HdfTree> read_hdf5(const std::filesystem::path& path, const HdfParts& parts);
Result<void> write_hdf5(const HdfTree& tree, const std::filesystem::path& path);

/// The same as HDF5-JSON [hdf5-json.readthedocs.io], as scalismo reads and writes it. Errors: not JSON, no root, a
/// dataset whose values do not fill its shape, values that the file has no room for.
Result<HdfTree> read_hdf5_json(const std::filesystem::path& path, const HdfParts& parts);
Result<void> write_hdf5_json(const HdfTree& tree, const std::filesystem::path& path);

}  // namespace homolog

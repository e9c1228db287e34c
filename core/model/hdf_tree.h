#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// What the files of statismo and scalismo are made of: groups named by paths ("/model"), which hold text attributes
/// and datasets.
struct HdfTree {
  struct Dataset {
    std::vector<std::size_t> dims;  ///< row-major; empty for a single value
    std::variant<std::vector<float>, std::vector<std::int32_t>, std::string> values;
  };
  std::map<std::string, std::map<std::string, std::string>> groups;  ///< path → attributes
  std::map<std::string, Dataset> datasets;                           ///< by path, "/model/mean"

  const std::vector<float>* floats(const std::string& path) const;
  const std::vector<std::int32_t>* integers(const std::string& path) const;
  /// Empty where absent.
  std::string text(const std::string& path) const;
  std::string attribute(const std::string& group, const std::string& name) const;
};

/// HDF5 itself, by libhdf5. Every number becomes float or int32 on reading. Errors: not HDF5, damaged, a dataset larger
/// than the file can hold.
Result<HdfTree> read_hdf5(const std::filesystem::path& path);
Result<void> write_hdf5(const HdfTree& tree, const std::filesystem::path& path);

/// The same tree as HDF5-JSON [hdf5-json.readthedocs.io], as scalismo reads and writes it. Errors: not JSON, no root, a
/// dataset whose values do not fill its shape.
Result<HdfTree> read_hdf5_json(const std::filesystem::path& path);
Result<void> write_hdf5_json(const HdfTree& tree, const std::filesystem::path& path);

}  // namespace homolog

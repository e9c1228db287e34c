#include "core/model/files/hdf5_reader.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <string_view>

#include "core/base/files/files.h"
#include "core/base/processes/confined.h"

// read_hdf5 starts the program once more, which reads the file before its `main` and writes what it found to its
// standard output: records that begin with one character and hold texts (their size, their bytes) and numbers as they
// lie in memory.
namespace homolog {
namespace fs = std::filesystem;

namespace {

constexpr const char* reader_verb = "--read-hdf5-in-this-process";
constexpr char attribute_record = 'a', dataset_record = 'd', error_record = 'e', end_record = '.';

Error damaged(const fs::path& path) {
  return {path.string(), "is a damaged HDF5 file; copy or export it again"};
}

// ---- the child's side

class Sender {
 public:
  explicit Sender(std::FILE* out) : out_(out) {}
  void send_error(const Error& error) {
    send(error_record);
    send(error.what);
  }
  void send_tree(const HdfTree& tree) {
    for (const auto& [group, attributes] : tree.groups)
      for (const auto& [name, value] : attributes) {
        send(attribute_record);
        for (const std::string* text : {&group, &name, &value}) send(*text);
      }
    for (const auto& [path, dataset] : tree.datasets) {
      send(dataset_record);
      send(path);
      send(dataset.dims);
      send(static_cast<char>(dataset.values.index()));
      std::visit([this](const auto& values) { send(values); }, dataset.values);
    }
    send(end_record);
  }

 private:
  void send(char c) { std::fputc(c, out_); }
  template <class Values>
  void send(const Values& values) {
    const std::uint64_t size = values.size();
    std::fwrite(&size, sizeof size, 1, out_);
    std::fwrite(values.data(), sizeof *values.data(), size, out_);
  }
  std::FILE* out_;
};

/// The parts as arguments of a command and back.
std::vector<std::string> arguments_of(const fs::path& file, const HdfParts& parts) {
  std::vector<std::string> arguments{reader_verb, file.string()};
  for (const auto& [group, name] : parts.attributes) arguments.insert(arguments.end(), {"attribute", group, name});
  for (const std::string& path : parts.datasets) arguments.insert(arguments.end(), {"dataset", path});
  for (const std::string& path : parts.numbered) arguments.insert(arguments.end(), {"numbered", path});
  return arguments;
}

HdfParts parts_named(const std::vector<std::string>& arguments) {
  HdfParts parts;
  for (std::size_t k = 2; k + 1 < arguments.size(); k += 2) {
    if (arguments[k] == "dataset") parts.datasets.push_back(arguments[k + 1]);
    if (arguments[k] == "numbered") parts.numbered.push_back(arguments[k + 1]);
    if (arguments[k] != "attribute" || k + 2 >= arguments.size()) continue;
    parts.attributes.emplace_back(arguments[k + 1], arguments[k + 2]);
    ++k;
  }
  return parts;
}

/// Reads the file that `arguments` name, confined. The exit status.
int read_and_send(const std::vector<std::string>& arguments) {
  const fs::path path = arguments[1];
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error), bytes = error ? 0 : size;
  // The values, once more on their way through the library, and what it needs for itself.
  confine_this_process(3 * most_value_bytes(bytes) + (std::uintmax_t{64} << 20), most_reading_seconds(bytes));
  Sender sender(stdout);
  try {
    if (auto tree = read_hdf5_unconfined(path, parts_named(arguments)))
      sender.send_tree(*tree);
    else
      sender.send_error(tree.error());
  } catch (const std::bad_alloc&) {
    return 1;  // the parent calls it damaged: it asked for more than it can hold
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}

/// The child ends here, before any `main`: so every program that reads models can be started so, the tests and those
/// of others who use the core too, and none has to know of it.
__attribute__((constructor)) void read_instead_of_main(int argc, char** argv) {
  if (argc > 2 && std::string_view(argv[1]) == reader_verb) std::_Exit(read_and_send({argv + 1, argv + argc}));
}

// ---- the parent's side

/// Reads what a child wrote; nothing of it is believed.
class Receiver {
 public:
  Receiver(std::FILE* in, std::uintmax_t most_bytes) : in_(in), left_(most_bytes) {}

  /// Errors: with an empty `what`, the child broke off or wrote nonsense; else what it found wrong with the file.
  Result<HdfTree> receive() {
    const auto broke_off = fail("", "");
    HdfTree tree;
    for (int record = std::fgetc(in_); record != end_record; record = std::fgetc(in_)) {
      if (record == error_record) {
        std::string what;
        return receive(what) ? fail("", std::move(what)) : broke_off;
      }
      if (record == attribute_record) {
        std::string group, name, value;
        if (!receive(group) || !receive(name) || !receive(value) || !is_path(group)) return broke_off;
        tree.add_group(group)[name] = std::move(value);
      } else if (record != dataset_record || !receive_dataset(tree)) {
        return broke_off;
      }
    }
    return tree;
  }

 private:
  static bool is_path(const std::string& path) { return path.starts_with('/'); }

  bool receive_dataset(HdfTree& tree) {
    std::string path;
    HdfTree::Dataset dataset;
    if (!receive(path) || !is_path(path) || !receive(dataset.dims)) return false;
    switch (std::fgetc(in_)) {
      case 0:
        if (!receive(dataset.values.emplace<0>())) return false;
        break;
      case 1:
        if (!receive(dataset.values.emplace<1>())) return false;
        break;
      case 2:
        if (!receive(dataset.values.emplace<2>())) return false;
        break;
      default:
        return false;
    }
    tree.add_group(path.substr(0, std::max<std::size_t>(path.rfind('/'), 1)));
    tree.datasets[path] = std::move(dataset);
    return true;
  }

  template <class Values>
  bool receive(Values& values) {
    std::uint64_t size = 0;
    if (std::fread(&size, sizeof size, 1, in_) != 1 || size > left_ / sizeof *values.data()) return false;
    left_ -= size * sizeof *values.data();
    values.resize(size);
    return std::fread(values.data(), sizeof *values.data(), size, in_) == size;
  }

  std::FILE* in_;
  std::uintmax_t left_;
};

}  // namespace

unsigned most_reading_seconds(std::uintmax_t bytes) {
  return 1 + static_cast<unsigned>(std::min<std::uintmax_t>(bytes >> 20, 3600));
}

Result<HdfTree> read_hdf5(const fs::path& path, const HdfParts& parts) {
  const auto bytes = size_of_file(path);
  if (!bytes) return fail(bytes.error());
  auto child = ConfinedChild::start(arguments_of(path, parts));
  if (!child) return fail(path.string(), child.error().what);
  constexpr std::uintmax_t names = 1 << 20;
  auto tree = Receiver(child->output(), most_value_bytes(*bytes) + names).receive();
  if (tree) return tree;
  return tree.error().what.empty() ? fail(damaged(path)) : fail(path.string(), tree.error().what);
}

}  // namespace homolog

#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/enumerators.h"
#include "core/base/numbers/geometry.h"
#include "core/base/result.h"
#include "core/base/text/text.h"

namespace homolog {

/// Why a line cannot be read, as the end of a sentence. Thrown, as the JSON library throws too; `caught` makes an Error
/// of both.
struct Unreadable {
  std::string what;
};

/// Runs a reader and turns whatever it throws into an Error.
template <class Read>
auto caught(const Read& read) -> Result<decltype(read())> {
  try {
    return read();
  } catch (const Unreadable& error) {
    return fail("", error.what);
  } catch (const nlohmann::json::out_of_range&) {
    return fail("", "lacks a key that its kind of line needs");
  } catch (const nlohmann::json::exception&) {
    return fail("", "holds a value of the wrong kind");
  }
}

/// The names of an enumeration's values in a case file. Each has one, or what uses them does not compile.
template <class Value, std::size_t count>
using Names = std::array<std::pair<const char*, Value>, count>;

template <class Value, std::size_t count>
const char* name_of(const Names<Value, count>& names, Value value) {
  for (const auto& [name, known] : names)
    if (known == value) return name;
  throw std::logic_error("a value of an enumeration has no name");
}

/// The members of a JSON object, read into an action or written from it. So one description of them serves both ways.
/// Members are written in the order in which they are named. Reading throws; see `caught`.
class Fields {
 public:
  using Json = nlohmann::ordered_json;

  /// Both keep a reference.
  static Fields reader(const Json& from) { return {&from, nullptr}; }
  static Fields writer(Json& to) { return {nullptr, &to}; }
  bool reads() const { return from_ != nullptr; }
  /// Whether a line that is read has a member.
  bool has(const char* key) const { return reads() && from_->contains(key); }

  /// A member that every line has. A place, and a number whose key ends in "_mm", is at most farthest_mm.
  template <class Value>
  void member(const char* key, Value& value) {
    if (!reads()) {
      (*to_)[key] = written(value);
      return;
    }
    const Json& from = needed(key);
    try {
      read(from, key, value);
    } catch (const Json::type_error&) {
      throw Unreadable{std::string("\"") + key + "\" holds a value of the wrong kind"};
    }
  }
  /// The same for an enumeration.
  template <class Value, std::size_t count>
  void member(const char* key, const Names<Value, count>& names, Value& value) {
    if constexpr (std::is_enum_v<Value>) static_assert(count == enumerators<Value>(), "each value needs its name");
    std::string name = name_of(names, value);
    member(key, name);
    if (reads()) value = named(names, name);
  }
  void member(const char* key, Similarity& value) { object(key).similarity(value); }
  /// How many of something: 0 … 1,000,000.
  void count(const char* key, int& value);
  /// A member that a line may lack: `value` stays as it is then.
  template <class Value>
  void optional(const char* key, Value& value, bool is_written = true) {
    if (reads() ? from_->contains(key) : is_written) member(key, value);
  }
  /// A member that a line has where there is a value.
  template <class Value>
  void optional(const char* key, std::optional<Value>& value) {
    if (reads() && from_->contains(key)) value.emplace();
    if (value) member(key, *value);
  }
  /// A member that is null where there is no value; a line that was written by hand may lack it then.
  template <class Value>
  void or_null(const char* key, std::optional<Value>& value) {
    if (reads() && from_->contains(key) && !from_->at(key).is_null()) value.emplace();
    if (value)
      member(key, *value);
    else if (!reads())
      (*to_)[key] = nullptr;
  }
  /// A member that always has the same value; `fault` says so where a line has another.
  void constant(const char* key, const Json& value, const char* fault);
  /// For a member that is an object itself: the members of that object.
  Fields object(const char* key);
  /// The members of a placement.
  void similarity(Similarity& value);

 private:
  Fields(const Json* from, Json* to) : from_(from), to_(to) {}

  /// The value of a key that the line must have.
  const Json& needed(const char* key) const;

  static void read(const Json& from, const char* key, bool& to);
  static void read(const Json& from, const char* key, int& to);
  static void read(const Json& from, const char* key, std::int64_t& to);
  static void read(const Json& from, const char* key, double& to);
  static void read(const Json& from, const char* key, std::size_t& to);
  static void read(const Json& from, const char* key, std::string& to);
  static void read(const Json& from, const char* key, std::filesystem::path& to);
  static void read(const Json& from, const char* key, std::vector<std::string>& to);
  static void read(const Json& from, const char* key, std::vector<std::filesystem::path>& to);
  static void read(const Json& from, const char* key, Json& to);
  static void read(const Json& from, const char* key, std::vector<double>& to);
  static void read(const Json& from, const char* key, std::vector<int>& to);
  static void read(const Json& from, const char* key, Vec3& to);
  static void read(const Json& from, const char* key, Eigen::Quaterniond& to);  ///< a rotation
  template <class Value>
  static Json written(const Value& value) {
    return value;
  }
  static Json written(const std::filesystem::path& value);
  static Json written(const std::vector<std::filesystem::path>& value);
  static Json written(const Vec3& value);
  static Json written(const Eigen::Quaterniond& value);

  template <class Value, std::size_t count>
  static Value named(const Names<Value, count>& names, const std::string& given) {
    std::string known_names;
    for (const auto& [name, known] : names) {
      if (given == name) return known;
      known_names += std::string(known_names.empty() ? "" : ", ") + name;
    }
    throw Unreadable{"\"" + excerpt(given) + "\" is not one of " + known_names};
  }

  const Json* from_;
  Json* to_;
};

}  // namespace homolog

#include "core/case/actions/fields.h"

#include <cmath>
#include <string_view>
#include <utility>

#include "core/base/numbers/limits.h"

namespace homolog {

namespace {

/// Errors: no whole number, none that `Number` holds.
template <class Number>
Number whole_number(const Fields::Json& from) {
  if (!from.is_number_integer()) throw Unreadable{excerpt(from.dump()) + " is not a whole number"};
  const bool is_large = from.is_number_unsigned();
  if (is_large ? !std::in_range<Number>(from.get<std::uint64_t>()) : !std::in_range<Number>(from.get<std::int64_t>()))
    throw Unreadable{excerpt(from.dump()) + " is out of range"};
  return from.get<Number>();
}

}  // namespace

const Fields::Json& Fields::needed(const char* key) const {
  if (!from_->contains(key))
    throw Unreadable{std::string("lacks the key \"") + key + "\", which its kind of line needs"};
  return from_->at(key);
}

void Fields::count(const char* key, int& value) {
  constexpr int most = 1'000'000;
  member(key, value);
  if (reads() && (value < 0 || value > most)) throw Unreadable{std::to_string(value) + " is out of range"};
}

void Fields::constant(const char* key, const Json& value, const char* fault) {
  if (!reads())
    (*to_)[key] = value;
  else if (needed(key) != value)
    throw Unreadable{fault};
}

Fields Fields::object(const char* key) {
  if (reads()) return reader(needed(key));
  return writer((*to_)[key] = Json::object());
}

void Fields::similarity(Similarity& value) {
  member("rotation", value.rotation);
  member("scale", value.scale);
  member("translation", value.translation);
}

void Fields::read(const Json& from, const char*, bool& to) {
  to = from.get<bool>();
}

void Fields::read(const Json& from, const char*, int& to) {
  to = whole_number<int>(from);
}

void Fields::read(const Json& from, const char*, std::int64_t& to) {
  to = whole_number<std::int64_t>(from);
}

void Fields::read(const Json& from, const char* key, double& to) {
  to = from.get<double>();
  if (std::string_view(key).ends_with("_mm") && !is_in_reach(to))
    throw Unreadable{std::string("\"") + key + "\" " + beyond_farthest};
}

void Fields::read(const Json& from, const char*, std::size_t& to) {
  to = whole_number<std::size_t>(from);
}

void Fields::read(const Json& from, const char*, std::filesystem::path& to) {
  to = from.get<std::string>();
}

void Fields::read(const Json& from, const char*, std::vector<std::string>& to) {
  to = from.get<std::vector<std::string>>();
}

void Fields::read(const Json& from, const char*, std::vector<std::filesystem::path>& to) {
  const auto paths = from.get<std::vector<std::string>>();
  to.assign(paths.begin(), paths.end());
}

void Fields::read(const Json& from, const char*, Json& to) {
  to = from;
}

void Fields::read(const Json& from, const char*, std::string& to) {
  to = from.get<std::string>();
}

void Fields::read(const Json& from, const char*, std::vector<double>& to) {
  to = from.get<std::vector<double>>();
}

void Fields::read(const Json& from, const char* key, std::vector<int>& to) {
  if (!from.is_array()) throw Unreadable{std::string("\"") + key + "\" is no list of whole numbers"};
  to.clear();
  for (const Json& one : from) read(one, key, to.emplace_back());
}

void Fields::read(const Json& from, const char* key, Vec3& to) {
  if (!from.is_array() || from.size() != 3) throw Unreadable{std::string("\"") + key + "\" is not [x,y,z]"};
  to = {from[0].get<double>(), from[1].get<double>(), from[2].get<double>()};
  if (!all_in_reach(to)) throw Unreadable{std::string("\"") + key + "\" " + beyond_farthest};
}

void Fields::read(const Json& from, const char* key, Eigen::Quaterniond& to) {
  const std::string name = std::string("\"") + key + "\"";
  if (!from.is_array() || from.size() != 4) throw Unreadable{name + " is not [w,x,y,z]"};
  to = {from[0].get<double>(), from[1].get<double>(), from[2].get<double>(), from[3].get<double>()};
  if (!(to.norm() > 1e-6)) throw Unreadable{name + " is zero"};
  // A quaternion that is unit to the last digits is taken as it is, so that what was written reads back the same.
  if (std::abs(to.norm() - 1) > 1e-9) to.normalize();
}

Fields::Json Fields::written(const std::filesystem::path& value) {
  return value.string();
}

Fields::Json Fields::written(const std::vector<std::filesystem::path>& value) {
  Json paths = Json::array();
  for (const auto& path : value) paths.push_back(path.string());
  return paths;
}

Fields::Json Fields::written(const Vec3& value) {
  return Json::array({value[0], value[1], value[2]});
}

Fields::Json Fields::written(const Eigen::Quaterniond& value) {
  return Json::array({value.w(), value.x(), value.y(), value.z()});
}

}  // namespace homolog

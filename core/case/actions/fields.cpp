#include "core/case/actions/fields.h"

#include <cmath>

namespace homolog {

void Fields::constant(const char* key, const Json& value, const char* fault) {
  if (!reads())
    (*to_)[key] = value;
  else if (from_->at(key) != value)
    throw Unreadable{fault};
}

Fields Fields::object(const char* key) {
  if (reads()) return reader(from_->at(key));
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
  if (!from.is_number_integer()) throw Unreadable{excerpt(from.dump()) + " is not a whole number"};
  const auto number = from.get<std::int64_t>();
  if (number < 0 || number > 1000000) throw Unreadable{excerpt(from.dump()) + " is out of range"};
  to = static_cast<int>(number);
}

void Fields::read(const Json& from, const char*, std::int64_t& to) {
  to = from.get<std::int64_t>();
}

void Fields::read(const Json& from, const char*, double& to) {
  to = from.get<double>();
}

void Fields::read(const Json& from, const char*, std::size_t& to) {
  to = from.get<std::size_t>();
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

void Fields::read(const Json& from, const char* key, Vec3& to) {
  if (!from.is_array() || from.size() != 3) throw Unreadable{std::string("\"") + key + "\" is not [x,y,z]"};
  to = {from[0].get<double>(), from[1].get<double>(), from[2].get<double>()};
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

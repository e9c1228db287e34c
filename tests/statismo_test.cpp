#include "core/model/statismo.h"

#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/files.h"
#include "core/model/hdf_tree.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;
using Json = nlohmann::json;

namespace {

ShapeModel some_model(bool with_faces = true) {
  const Mesh ball = icosphere(1, 20);
  ShapeMatrix shapes(ball.points.size(), 5);
  std::srand(2);
  shapes.setRandom();
  shapes.colwise() += Eigen::Map<const Eigen::VectorXd>(ball.points.data(), ball.points.size());
  return make_model(principal_components(shapes), 0.9, with_faces ? ball.topology : nullptr,
                    {"a", "b", "Nière", "d", "e"});
}

void check_same(const ShapeModel& a, const ShapeModel& b) {
  CHECK(static_cast<bool>(a.topology) == static_cast<bool>(b.topology));
  if (a.topology && b.topology) CHECK(a.topology->hash() == b.topology->hash());
  REQUIRE(a.modes() == b.modes());
  CHECK((a.mean - b.mean).cwiseAbs().maxCoeff() < 1e-5);
  CHECK((a.basis - b.basis).cwiseAbs().maxCoeff() < 1e-7);
  CHECK((a.variances - b.variances).cwiseAbs().maxCoeff() < 1e-6);
  CHECK((a.scores - b.scores).cwiseAbs().maxCoeff() < 1e-5);
  CHECK(a.names == b.names);
}

/// The dataset at a path of an HDF5-JSON file, followed link by link from the root.
Json dataset_at(const Json& file, const std::vector<std::string>& path) {
  std::string id = file["root"];
  for (std::size_t k = 0; k < path.size(); ++k) {
    std::string next, collection;
    for (const Json& link : file["groups"][id]["links"])
      if (link["title"] == path[k]) next = link["id"], collection = link["collection"];
    REQUIRE_MESSAGE(!next.empty(), path[k]);
    CHECK(collection == (k + 1 < path.size() ? "groups" : "datasets"));
    id = next;
  }
  return file["datasets"][id];
}

void change(const fs::path& path, const std::string& from, const std::string& to) {
  std::string text = read_whole_file(path).value();
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  std::ofstream(path) << text.replace(at, from.size(), to);
}

void check_refused(const fs::path& path, const std::string& what) {
  const auto read = read_model(path);
  REQUIRE(!read);
  INFO(read.error().sentence());
  CHECK(read.error().sentence().find(path.filename().string()) != std::string::npos);
  CHECK(read.error().what.find(what) != std::string::npos);
}

}  // namespace

TEST_CASE("a model reads back from both formats as it was written") {
  const TemporaryFolder folder;
  for (const std::string name : {"model.h5.json", "model.h5", "MODEL.H5"}) {
    for (const bool faces : {true, false}) {
      const ShapeModel model = some_model(faces);
      REQUIRE(write_model(model, folder.path / name));
      const auto read = read_model(folder.path / name);
      REQUIRE_MESSAGE(read, read.error().sentence());
      check_same(model, *read);
    }
  }
  CHECK(!write_model(some_model(), folder.path / "model.json"));
}

TEST_CASE("both formats hold the same tree") {
  const TemporaryFolder folder;
  REQUIRE(write_model(some_model(), folder.path / "m.h5"));
  HdfTree tree = read_hdf5(folder.path / "m.h5").value();
  REQUIRE(write_hdf5_json(tree, folder.path / "m.h5.json"));
  const HdfTree again = read_hdf5_json(folder.path / "m.h5.json").value();
  CHECK(again.groups == tree.groups);
  REQUIRE(again.datasets.size() == tree.datasets.size());
  for (const auto& [path, dataset] : tree.datasets) {
    CHECK_MESSAGE(again.datasets.at(path).dims == dataset.dims, path);
    CHECK_MESSAGE(again.datasets.at(path).values == dataset.values, path);
  }
}

TEST_CASE("the JSON file has the layout that statismo and scalismo 0.9 publish") {
  const TemporaryFolder folder;
  const ShapeModel model = some_model();
  REQUIRE(write_model(model, folder.path / "m.h5.json"));
  const Json file = Json::parse(read_whole_file(folder.path / "m.h5.json").value());
  CHECK(file["apiVersion"].is_string());
  CHECK(dataset_at(file, {"version", "majorVersion"})["value"] == 0);
  CHECK(dataset_at(file, {"version", "minorVersion"})["value"] == 9);
  CHECK(dataset_at(file, {"version", "minorVersion"})["shape"] == Json{{"class", "H5S_SCALAR"}});

  const Json points = dataset_at(file, {"representer", "points"});
  CHECK(points["shape"] == Json{{"class", "H5S_SIMPLE"}, {"dims", {3, 42}}});
  CHECK(points["type"] == Json{{"class", "H5T_FLOAT"}, {"base", "H5T_IEEE_F32LE"}});
  CHECK(points["value"][1][5].get<double>() == doctest::Approx(model.mean[3 * 5 + 1]));
  const Json cells = dataset_at(file, {"representer", "cells"});
  CHECK(cells["shape"]["dims"] == Json::array({3, 80}));
  CHECK(cells["type"] == Json{{"class", "H5T_INTEGER"}, {"base", "H5T_STD_I32LE"}});
  CHECK(cells["value"][2][7] == model.topology->triangles()(7, 2));

  CHECK(dataset_at(file, {"model", "mean"})["shape"]["dims"] == Json::array({126}));
  CHECK(dataset_at(file, {"model", "mean"})["value"][4].get<double>() == doctest::Approx(model.mean[4]));
  const Json basis = dataset_at(file, {"model", "pcaBasis"});
  CHECK(basis["shape"]["dims"] == Json::array({126, model.modes()}));
  CHECK(basis["value"][9][1].get<double>() == doctest::Approx(model.basis(9, 1)));
  CHECK(dataset_at(file, {"model", "pcaVariance"})["shape"]["dims"] == Json::array({model.modes()}));
  CHECK(dataset_at(file, {"model", "noiseVariance"})["value"][0] == 0);
  CHECK(dataset_at(file, {"modelinfo", "build-time"})["type"]["class"] == "H5T_STRING");
  CHECK(dataset_at(file, {"modelinfo", "scores"})["shape"]["dims"] == Json::array({model.modes(), 5}));

  std::map<std::string, std::string> attributes;
  for (const auto& [id, group] : file["groups"].items())
    if (group["alias"][0] == "/representer")
      for (const Json& attribute : group["attributes"]) attributes[attribute["name"]] = attribute["value"];
  CHECK(attributes["datasetType"] == "POLYGON_MESH");
  CHECK(attributes.contains("name"));
  CHECK(attributes.contains("version"));
}

TEST_CASE("a model of version 0.8 is read with its basis made orthonormal") {
  const TemporaryFolder folder;
  const ShapeModel model = some_model();
  ShapeModel old = model;
  old.basis *= model.variances.cwiseSqrt().asDiagonal();
  REQUIRE(write_model(old, folder.path / "old.h5"));
  HdfTree tree = read_hdf5(folder.path / "old.h5").value();
  tree.datasets["/version/minorVersion"].values = std::vector<std::int32_t>{8};
  REQUIRE(write_hdf5(tree, folder.path / "old.h5"));
  check_same(model, read_model(folder.path / "old.h5").value());
  tree.datasets["/version/minorVersion"].values = std::vector<std::int32_t>{7};
  REQUIRE(write_hdf5(tree, folder.path / "old.h5"));
  check_refused(folder.path / "old.h5", "version 0.7");
}

TEST_CASE("a file that is no model or a damaged one is refused with the fault named") {
  const TemporaryFolder folder;
  const fs::path json = folder.path / "m.h5.json", hdf5 = folder.path / "m.h5";
  check_refused(json, "does not exist");
  check_refused(hdf5, "does not exist");
  for (const std::string text : {"", "{}", "[1,2]", "not JSON", R"({"root":"x","groups":{}})",
                                 R"({"root":"x","groups":{"x":{"links":[{"class":"H5L_TYPE_HARD","title":"x",
                                 "collection":"groups","id":"x"}]}}})"}) {
    std::ofstream(json) << text;
    CHECK(!read_model(json));
    std::ofstream(hdf5) << text;
    check_refused(hdf5, "HDF5");
  }
  const auto refuse_changed = [&](const std::string& from, const std::string& to, const std::string& what) {
    REQUIRE(write_model(some_model(), json));
    change(json, from, to);
    check_refused(json, what);
  };
  refuse_changed("\"dims\":[126]", "\"dims\":[127]", "fill its shape");
  refuse_changed("POLYGON_MESH", "IMAGE", "IMAGE");
  refuse_changed("pcaBasis", "pcaBasic", "/model/pcaBasis");

  REQUIRE(write_model(some_model(), hdf5));
  const std::string whole = read_whole_file(hdf5).value();
  for (const std::size_t size : {whole.size() / 4, whole.size() / 2, whole.size() - 100}) {
    std::ofstream(hdf5) << whole.substr(0, size);
    CHECK(!read_model(hdf5));
  }
  ShapeModel bent = some_model();
  bent.mean.conservativeResize(123);
  REQUIRE(write_model(bent, hdf5));
  check_refused(hdf5, "does not fit");
}

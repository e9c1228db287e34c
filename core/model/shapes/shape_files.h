#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/case/document.h"
#include "core/mesh/mesh_io.h"
#include "core/session/case_file.h"

namespace homolog {

struct StudyCase;

/// The shapes of one structure.
struct ShapesOfStructure {
  std::string id;                                         ///< empty: of a mesh
  std::map<int, std::shared_ptr<const MeshFile>> frames;  ///< frame 0 alone where it is no cine
  std::vector<int> edited;                                ///< frames that were worked on, ascending
  std::string name{};                                     ///< empty: it has none
};

/// Which shape of a file is meant.
struct WhichShape {
  std::string structure{};     ///< the structure, by its id; empty: the first
  std::optional<int> frame{};  ///< none: the one that is shown
};

/// The shapes that one file holds.
struct ShapesOfFile {
  std::vector<ShapesOfStructure> structures;  ///< one of a mesh; none of a case without a template
  int shown = 0;                              ///< the frame that a case shows
  std::vector<std::string> warnings;          ///< each a sentence

  /// A structure by its id; the empty id is the first one's. Null: there is none.
  const ShapesOfStructure* structure(std::string_view id) const;
  /// Errors: there is no such structure, or no mesh of it in the frame.
  Result<std::shared_ptr<const MeshFile>> shape(const WhichShape& which, const std::string& name) const;
};

/// The meshes of a case that is open. A landmark that was placed in the image lies there; the template's others where
/// the mesh has them. The array `confirmed` says what is confirmed, 0 free … 1 held.
ShapesOfFile shapes_of(const Document& document);
/// Reads a mesh (PLY, VTK, VTP, OBJ), `.particles`, or the meshes of a case file. Errors: read_mesh_file's,
/// read_case's, an STL file, which keeps no vertices.
Result<ShapesOfFile> read_shapes_of(const std::filesystem::path& file);

/// Finds what is the same in meshes that come one after the other, from several threads: those of a study have one
/// template.
class KnownParts {
 public:
  /// Takes the faces and the stiffness that came before in place of the same ones of this mesh.
  void share(MeshFile& mesh);

 private:
  std::mutex mutex_;
  std::vector<SharedTriangles> triangles_;
  std::vector<std::shared_ptr<const VertexScalars>> stiffness_;
};

/// Data shared by threads that read many files.
struct ReadTogether {
  std::mutex one_image;  ///< held while a case is read with its image: images of several would take much memory
  KnownParts parts;      ///< parts of the meshes that were read
};
Result<ShapesOfFile> read_shapes_of(const std::filesystem::path& file, ReadTogether& together);

/// The source of a shape of a training set.
struct ShapeSource {
  std::filesystem::path file;
  std::optional<int> frame;  ///< a cine case's frame; the one it shows where absent
  bool flipped = false;      ///< left for right
  std::string doubt{};       ///< why a person has to look at a study's case, and has not yet; empty: no doubt
  std::string group{};       ///< the group of a study's case; empty: none
  bool done = false;         ///< a study's case that somebody looked at and found done
  std::string structure{};   ///< a case's structure, by its id; empty: the first
  std::string study_case{};  ///< the name of a study's case in the study; empty: of none

  /// The key that tells a study's case from all others, whichever of its frames is taken; empty: of none.
  std::string study_key() const { return study_case.empty() ? std::string() : file.string() + '\n' + study_case; }
  /// "case_3.homolog", with its structure and its frame where one of several is taken.
  std::string name(const std::optional<int>& of_frame) const {
    return file.string() + (structure.empty() ? "" : " structure " + structure) +
           (of_frame ? " frame " + std::to_string(*of_frame) : "");
  }
};
/// The shape of a study's case. One that is done is in no doubt.
ShapeSource source_of(const StudyCase& one);
/// Files as sources, one each; a folder stands for its shapes [shape_folder.h], a study (*.study.json) stands for its
/// cases, of one group where `group` is not empty. Cases of a study without a shape of their own yet are no sources.
/// Errors: a study that cannot be read, a group without a study or that no case belongs to.
Result<std::vector<ShapeSource>> shape_sources(const std::vector<std::filesystem::path>& files,
                                               const std::string& group = {});

/// Reads one, a flipped one flipped. Errors: read_shapes_of's, no such structure.
Result<std::shared_ptr<const MeshFile>> read_shape(const ShapeSource& source);

/// A shape that was read.
struct ReadShape {
  std::string name;                 ///< the file's, with the frame where one of several is taken
  const ShapeSource* of = nullptr;  ///< its source, one of those that were given
  std::shared_ptr<const MeshFile> mesh;
  std::string doubt;  ///< why it is in doubt; empty: it is not, or nobody asked
  /// The other structures of a case at the same frame, by their names (their ids, where they have none).
  std::vector<std::pair<std::string, std::shared_ptr<const MeshFile>>> others{};
  std::string structure{};  ///< its own name among them; empty: of a mesh
};
using TakeShape = std::function<Result<void>(ReadShape shape)>;

struct ShapeReading {
  bool all_frames = false;  ///< takes every edited frame of a cine case that names no frame
  bool doubts = false;      ///< looks for what is in doubt: what the study says of it, else `doubt_of_shape`
};
/// Reads sources, several at a time, and hands their shapes to `take` one after the other in the sources' order. A
/// source that cannot be read is left out; gives the sentences that say so. Errors: take's, an STL file, nothing that
/// could be read, cancelled.
Result<std::vector<std::string>> read_shapes(const std::vector<ShapeSource>& sources, const ShapeReading& reading,
                                             const TakeShape& take, Progress* progress = nullptr);

/// A shape to write.
struct NamedShape {
  std::string name;  ///< its file's name without extension; no two may be equal
  std::shared_ptr<const MeshFile> mesh;
  std::filesystem::path imported;  ///< the file it came from, for its format; empty: .ply
  bool changed = true;             ///< else the file it came from may be copied as it is
};
/// Writes shapes into `folder` (made where absent) as NAME.EXTENSION; without one (".ply", ".particles") each in the
/// format it was imported in. Numbering is kept. Errors: a name that cannot be a file's, cancelled.
Result<void> write_shapes(const std::vector<NamedShape>& shapes, const std::string& extension,
                          const std::filesystem::path& folder, Progress* progress = nullptr);

}  // namespace homolog

#pragma once

#include <ostream>
#include <string>
#include <string_view>

#include "core/mesh/mesh_io.h"

/// The single mesh formats behind mesh_io.h. Readers take the bytes of a whole file, writers a mesh that fits their
/// format; errors name no file. Readers need not check that coordinates are finite or indices in range.
namespace homolog::formats {

Result<MeshFile> read_ply(std::string_view bytes);
Result<MeshFile> read_vtk(std::string_view bytes);
Result<MeshFile> read_vtp(std::string_view bytes);
Result<MeshFile> read_obj(std::string_view bytes);
Result<MeshFile> read_stl(std::string_view bytes);
Result<MeshFile> read_particles(std::string_view bytes);

void write_ply(const MeshFile& mesh, std::ostream& out);
void write_vtk(const MeshFile& mesh, std::ostream& out);
void write_vtp(const MeshFile& mesh, std::ostream& out);
void write_obj(const MeshFile& mesh, std::ostream& out);
void write_stl(const MeshFile& mesh, std::ostream& out);
void write_particles(const MeshFile& mesh, std::ostream& out);

}  // namespace homolog::formats

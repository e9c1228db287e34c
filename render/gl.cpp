#include "render/gl.h"

#include <glm/gtc/type_ptr.hpp>
#include <string>
#include <vector>

namespace homolog::gl {
namespace {

/// Deletes a shader when the program that it was linked into no longer needs it.
struct Shader {
  explicit Shader(GLenum stage) : name(glCreateShader(stage)) {}
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  ~Shader() { glDeleteShader(name); }
  GLuint name;
};

Result<void> compile(const Shader& shader, std::string_view shared, std::string_view text) {
  constexpr std::string_view version_line = "#version 330 core\n";
  const std::array<const char*, 3> parts{version_line.data(), shared.data(), text.data()};
  const std::array<GLint, 3> lengths{static_cast<GLint>(version_line.size()), static_cast<GLint>(shared.size()),
                                     static_cast<GLint>(text.size())};
  glShaderSource(shader.name, 3, parts.data(), lengths.data());
  glCompileShader(shader.name);
  GLint compiled = 0;
  glGetShaderiv(shader.name, GL_COMPILE_STATUS, &compiled);
  if (compiled != 0) return {};
  std::string log(4096, '\0');
  GLsizei length = 0;
  glGetShaderInfoLog(shader.name, static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  return fail("", "the graphics driver refuses a shader of the program (update the driver): " + log);
}

}  // namespace

Result<Program> Program::make(std::string_view vertex, std::string_view fragment, std::string_view shared) {
  const Shader vertex_shader(GL_VERTEX_SHADER), fragment_shader(GL_FRAGMENT_SHADER);
  if (auto done = compile(vertex_shader, shared, vertex); !done) return fail(done.error());
  if (auto done = compile(fragment_shader, shared, fragment); !done) return fail(done.error());
  Program program;
  program.name_ = glCreateProgram();
  glAttachShader(program.name_, vertex_shader.name);
  glAttachShader(program.name_, fragment_shader.name);
  glLinkProgram(program.name_);
  GLint linked = 0;
  glGetProgramiv(program.name_, GL_LINK_STATUS, &linked);
  if (linked != 0) return program;
  std::string log(4096, '\0');
  GLsizei length = 0;
  glGetProgramInfoLog(program.name_, static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  return fail("", "the graphics driver cannot link a shader of the program (update the driver): " + log);
}

void Program::set(const char* name, int value) const {
  glUniform1i(glGetUniformLocation(name_, name), value);
}
void Program::set(const char* name, float value) const {
  glUniform1f(glGetUniformLocation(name_, name), value);
}
void Program::set(const char* name, const glm::vec2& value) const {
  glUniform2fv(glGetUniformLocation(name_, name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::vec3& value) const {
  glUniform3fv(glGetUniformLocation(name_, name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::mat4& value) const {
  glUniformMatrix4fv(glGetUniformLocation(name_, name), 1, GL_FALSE, glm::value_ptr(value));
}

void attribute(GLuint location, GLint floats, std::size_t stride_bytes, std::size_t offset_bytes, GLuint divisor) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, floats, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride_bytes),
                        reinterpret_cast<const void*>(offset_bytes));
  glVertexAttribDivisor(location, divisor);
}

}  // namespace homolog::gl

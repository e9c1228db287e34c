#pragma once

#include <epoxy/gl.h>

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string_view>
#include <utility>

#include "core/base/result.h"

namespace homolog::gl {

/// Owns one OpenGL object of a kind; it moves and is never copied. Made with `make()` in a current context, empty
/// (name 0) otherwise.
template <class Kind>
class Object {
 public:
  Object() = default;
  static Object make() {
    Object object;
    Kind::generate(&object.name_);
    return object;
  }
  Object(Object&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Object& operator=(Object&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~Object() {
    if (name_ != 0) Kind::remove(&name_);
  }
  GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
};

struct TextureKind {
  static void generate(GLuint* name) { glGenTextures(1, name); }
  static void remove(const GLuint* name) { glDeleteTextures(1, name); }
};
struct BufferKind {
  static void generate(GLuint* name) { glGenBuffers(1, name); }
  static void remove(const GLuint* name) { glDeleteBuffers(1, name); }
};
struct VertexArrayKind {
  static void generate(GLuint* name) { glGenVertexArrays(1, name); }
  static void remove(const GLuint* name) { glDeleteVertexArrays(1, name); }
};
struct RenderbufferKind {
  static void generate(GLuint* name) { glGenRenderbuffers(1, name); }
  static void remove(const GLuint* name) { glDeleteRenderbuffers(1, name); }
};
struct FramebufferKind {
  static void generate(GLuint* name) { glGenFramebuffers(1, name); }
  static void remove(const GLuint* name) { glDeleteFramebuffers(1, name); }
};

using Texture = Object<TextureKind>;
using Buffer = Object<BufferKind>;
using VertexArray = Object<VertexArrayKind>;
using Renderbuffer = Object<RenderbufferKind>;
using FramebufferObject = Object<FramebufferKind>;

/// A linked vertex and fragment shader. The texts hold no `#version`: it is put before them here, with `shared` (a
/// text that several fragment shaders have in common).
class Program {
 public:
  /// Errors: the driver refuses a shader; `what` holds its log.
  static Result<Program> make(std::string_view vertex, std::string_view fragment, std::string_view shared = "");
  Program() = default;
  Program(Program&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Program& operator=(Program&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~Program() {
    if (name_ != 0) glDeleteProgram(name_);
  }

  void use() const { glUseProgram(name_); }
  /// Uniforms of the program, which must be in use. A name that the shader does not have is ignored.
  void set(const char* name, int value) const;
  void set(const char* name, float value) const;
  void set(const char* name, const glm::vec2& value) const;
  void set(const char* name, const glm::vec3& value) const;
  void set(const char* name, const glm::mat4& value) const;

 private:
  GLuint name_ = 0;
};

/// Replaces the content of a buffer.
template <class T>
void upload(const Buffer& buffer, GLenum kind, std::span<const T> values, GLenum usage) {
  glBindBuffer(kind, buffer.name());
  glBufferData(kind, static_cast<GLsizeiptr>(values.size_bytes()), values.data(), usage);
}

/// One vertex attribute of `floats` floats in the bound array buffer; `divisor` 1 advances it once an instance.
void attribute(GLuint location, GLint floats, std::size_t stride_bytes, std::size_t offset_bytes, GLuint divisor);

}  // namespace homolog::gl

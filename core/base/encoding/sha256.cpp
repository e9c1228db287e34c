#include "core/base/encoding/sha256.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "core/base/files/files.h"
#include "core/base/files/open_file.h"

namespace homolog {

namespace {

/// The sum that grows with the bytes, by OpenSSL.
class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    good_ = context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1;
  }
  void add(std::string_view bytes) {
    good_ = good_ && EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1;
  }
  Result<std::string> digits() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> sum{};
    unsigned size = 0;
    if (!good_ || EVP_DigestFinal_ex(context_.get(), sum.data(), &size) != 1)
      return fail("", "its SHA-256 cannot be computed, since OpenSSL refuses; install libssl3 again");
    std::string text;
    for (unsigned k = 0; k < size; ++k) {
      text += "0123456789abcdef"[sum[k] >> 4];
      text += "0123456789abcdef"[sum[k] & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
  bool good_ = false;
};

}  // namespace

Result<std::string> sha256_of(std::string_view bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.digits();
}

Result<std::string> sha256_of_file(const std::filesystem::path& path, Progress* progress, std::uintmax_t most_bytes) {
  const auto size = size_of_file(path);
  if (!size) return fail(size.error());
  const auto file = OpenFile::open(path, OpenFile::For::reading);
  if (!file) return fail(path.string(), "cannot be read; check its rights");
  const std::uintmax_t bytes = std::min(*size, most_bytes);
  std::vector<char> buffer(std::size_t{1} << 20);
  Sha256 sum;
  for (std::uintmax_t at = 0; at < bytes;) {
    if (progress != nullptr && progress->cancelled()) return fail(path.string(), "cancelled");
    const auto most = static_cast<std::size_t>(std::min<std::uintmax_t>(buffer.size(), bytes - at));
    const auto got = file->read_at(buffer.data(), most, at);
    if (!got) return fail(path.string(), "cannot be read to its end; copy it again");
    if (*got == 0) break;
    sum.add({buffer.data(), *got});
    at += *got;
  }
  auto digits = sum.digits();
  if (!digits) return fail(path.string(), digits.error().what);
  return digits;
}

}  // namespace homolog

#include <zlib.h>

#include <array>
#include <cstdio>
#include <map>

#include "app/pictures/page.h"
#include "app/pictures/page_font.h"

// A page as PDF 1.5 [ISO 32000-1]: one page, its shapes as an image, Inter with the letters that are used.

namespace homolog {

namespace {

constexpr double pt_per_mm = 72 / 25.4;

std::string in_pdf(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 3).ptr;
  return std::string(text.data(), end) + ' ';
}

Result<std::string> deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string small(size, 0);
  if (compress2(reinterpret_cast<Bytef*>(small.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), Z_DEFAULT_COMPRESSION) != Z_OK)
    return fail("", "the page needs more memory than there is; make it smaller with --width-mm");
  small.resize(size);
  return small;
}

/// The objects of a file, numbered from 1, and the table of where they lie.
class PdfFile {
 public:
  /// Gives the object's number.
  int add(const std::string& object) {
    places_.push_back(bytes_.size());
    bytes_ += std::to_string(places_.size()) + " 0 obj\n" + object + "\nendobj\n";
    return static_cast<int>(places_.size());
  }
  Result<int> add_stream(const std::string& entries, const std::string& content) {
    const auto small = deflated(content);
    if (!small) return fail(small.error());
    return add("<<" + entries + "/Filter/FlateDecode/Length " + std::to_string(small->size()) + ">>\nstream\n" +
               *small + "\nendstream");
  }
  std::string whole(int catalog) && {
    const std::size_t table = bytes_.size();
    bytes_ += "xref\n0 " + std::to_string(places_.size() + 1) + "\n0000000000 65535 f \n";
    for (const std::size_t place : places_) {
      std::array<char, 24> line{};
      std::snprintf(line.data(), line.size(), "%010zu 00000 n \n", place);
      bytes_ += line.data();
    }
    return std::move(bytes_) + "trailer\n<</Size " + std::to_string(places_.size() + 1) + "/Root " +
           std::to_string(catalog) + " 0 R>>\nstartxref\n" + std::to_string(table) + "\n%%EOF\n";
  }

 private:
  std::string bytes_ = "%PDF-1.5\n%\xE2\xE3\xCF\xD3\n";
  std::vector<std::size_t> places_;
};

std::string reference(int object) {
  return ' ' + std::to_string(object) + " 0 R";
}

/// Channels of a picture, a byte each, every row with the differences to the pixel before, which deflate better.
std::string image_rows(const Picture& picture, std::size_t first, std::size_t channels) {
  std::string rows;
  const auto width = static_cast<std::size_t>(picture.width), height = static_cast<std::size_t>(picture.height);
  rows.reserve((channels * width + 1) * height);
  for (std::size_t y = 0; y < height; ++y) {
    rows += '\1';
    const std::uint8_t* row = picture.rgba.data() + 4 * width * y;
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t c = first; c < first + channels; ++c)
        rows += static_cast<char>(row[4 * x + c] - (x > 0 ? row[4 * x + c - 4] : 0));
  }
  return rows;
}

Result<int> add_image(PdfFile& file, const Picture& picture, bool transparent) {
  const auto entries = [&](int channels) {
    const std::string width = std::to_string(picture.width);
    return "/Type/XObject/Subtype/Image/BitsPerComponent 8/Width " + width + "/Height " +
           std::to_string(picture.height) + "/DecodeParms<</Predictor 15/Columns " + width + "/Colors " +
           std::to_string(channels) + ">>";
  };
  std::string mask;
  if (transparent) {
    const auto alpha = file.add_stream(entries(1) + "/ColorSpace/DeviceGray", image_rows(picture, 3, 1));
    if (!alpha) return fail(alpha.error());
    mask = "/SMask" + reference(*alpha);
  }
  return file.add_stream(entries(3) + "/ColorSpace/DeviceRGB" + mask, image_rows(picture, 0, 3));
}

std::string hex_of_number(unsigned value) {
  std::array<char, 12> text{};
  std::snprintf(text.data(), text.size(), "%04X", value);
  return text.data();
}

/// UTF-16, as the table from glyphs to letters has it.
std::string utf_16_hex(char32_t letter) {
  if (letter < 0x10000) return hex_of_number(letter);
  return hex_of_number(0xD800U + ((letter - 0x10000) >> 10)) + hex_of_number(0xDC00U + ((letter - 0x10000) & 0x3FFU));
}

/// Inter with the glyphs that are used; gives the font's object.
Result<int> add_font(PdfFile& file, const std::map<unsigned, PageGlyph>& used) {
  std::set<unsigned> kept;
  std::string widths, letters =
                          "/CIDInit /ProcSet findresource begin 12 dict begin begincmap /CMapType 2 def\n"
                          "/CMapName /Letters def 1 begincodespacerange <0000> <FFFF> endcodespacerange\n";
  for (const auto& [number, glyph] : used) {
    kept.insert(number);
    widths += std::to_string(number) + '[' + in_pdf(glyph.advance) + ']';
    letters += "1 beginbfchar <" + hex_of_number(number) + "> <" + utf_16_hex(glyph.letter) + "> endbfchar\n";
  }
  letters += "endcmap CMapName currentdict /CMap defineresource pop end end\n";
  const auto program = file.add_stream("/Subtype/CIDFontType0C", font_program(kept));
  if (!program) return program;
  const auto to_letters = file.add_stream("", letters);
  if (!to_letters) return to_letters;
  const int descriptor = file.add(
      "<</Type/FontDescriptor/FontName/HMLGAA+Inter-Regular/Flags 4/FontBBox[-800 -300 2600 1100]/ItalicAngle 0"
      "/Ascent 969/Descent -242/CapHeight 727/StemV 80/FontFile3" +
      reference(*program) + ">>");
  const int outlines = file.add(
      "<</Type/Font/Subtype/CIDFontType0/BaseFont/HMLGAA+Inter-Regular/CIDSystemInfo<</Registry(Adobe)"
      "/Ordering(Identity)/Supplement 0>>/FontDescriptor" +
      reference(descriptor) + "/W[" + widths + "]>>");
  return file.add("<</Type/Font/Subtype/Type0/BaseFont/HMLGAA+Inter-Regular/Encoding/Identity-H/DescendantFonts[" +
                  reference(outlines) + "]/ToUnicode" + reference(*to_letters) + ">>");
}

/// What is drawn on the page, in points from its lower left.
class PdfContent {
 public:
  explicit PdfContent(double height_mm) : height_mm_(height_mm) {}

  void add(const PagePath& path) {
    colour(path.colour, path.line_mm > 0 ? "RG " : "rg ");
    for (std::size_t k = 0; k < path.points_mm.size(); ++k) bytes += place(path.points_mm[k]) + (k == 0 ? "m " : "l ");
    bytes += path.line_mm > 0 ? in_pdf(path.line_mm * pt_per_mm) + "w 1 j S\n" : "h f\n";
  }

  void add(const PageText& text) {
    const auto glyphs = glyphs_of(text.text);
    const double share = static_cast<double>(text.anchor) / 2;
    Eigen::Vector2d at = text.at_mm;
    at.x() -= share * text_width_mm(text.text, text.size_pt);
    colour(text.colour, "rg ");
    const double mm = text.size_pt / 1000 / pt_per_mm;
    for (std::size_t k = 0; k < glyphs.size();) {
      if (!glyphs[k].inter) {
        add_outline(glyphs[k], at, mm);
        at.x() += mm * glyphs[k++].advance;
        continue;
      }
      bytes += "BT /F " + in_pdf(text.size_pt) + "Tf " + place(at) + "Td <";
      for (; k < glyphs.size() && glyphs[k].inter; ++k) {
        bytes += hex_of_number(glyphs[k].glyph);
        at.x() += mm * glyphs[k].advance;
        used.emplace(glyphs[k].glyph, glyphs[k]);
      }
      bytes += "> Tj ET\n";
    }
  }

  std::string bytes;
  std::map<unsigned, PageGlyph> used;  ///< of Inter, by number

 private:
  std::string place(const Eigen::Vector2d& mm) const {
    return in_pdf(mm.x() * pt_per_mm) + in_pdf((height_mm_ - mm.y()) * pt_per_mm);
  }
  void colour(const Rgb& rgb, const char* what) {
    for (const float part : rgb) bytes += in_pdf(part);
    bytes += what;
  }
  void add_outline(const PageGlyph& glyph, const Eigen::Vector2d& at, double mm) {
    const auto there = [&](const Eigen::Vector2d& point) {
      return place(at + mm * Eigen::Vector2d(point.x(), -point.y()));
    };
    const auto steps = outline_of(glyph);
    for (const GlyphStep& step : steps)
      bytes += step.kind == GlyphStep::Kind::move ? there(step.to) + "m "
               : step.kind == GlyphStep::Kind::line
                   ? there(step.to) + "l "
                   : there(step.control_1) + there(step.control_2) + there(step.to) + "c ";
    if (!steps.empty()) bytes += "f\n";
  }

  double height_mm_;
};

}  // namespace

Result<std::string> page_as_pdf(const Page& page) {
  PdfFile file;
  PdfContent content(page.height_mm);
  const std::string width = in_pdf(page.width_mm * pt_per_mm), height = in_pdf(page.height_mm * pt_per_mm);
  std::string resources;
  if (!page.transparent) {
    Page ground;
    ground.add_box(0, 0, page.width_mm, page.height_mm, page.ground);
    content.add(ground.paths.front());
  }
  if (page.shapes) {
    const auto image = add_image(file, *page.shapes, page.transparent);
    if (!image) return fail(image.error());
    resources += "/XObject<</Shapes" + reference(*image) + ">>";
    content.bytes += "q " + width + "0 0 " + height + "0 0 cm /Shapes Do Q\n";
  }
  for (const PagePath& path : page.paths) content.add(path);
  for (const PageText& text : page.texts) content.add(text);
  if (!content.used.empty()) {
    const auto font = add_font(file, content.used);
    if (!font) return fail(font.error());
    resources += "/Font<</F" + reference(*font) + ">>";
  }
  const auto drawn = file.add_stream("", content.bytes);
  if (!drawn) return fail(drawn.error());
  // The page names the list of pages, which comes after it.
  const int sheet = *drawn + 1;
  file.add("<</Type/Page/Parent" + reference(sheet + 1) + "/MediaBox[0 0 " + width + height + "]/Resources<<" +
           resources + ">>/Contents" + reference(*drawn) + ">>");
  const int pages = file.add("<</Type/Pages/Count 1/Kids[" + reference(sheet) + "]>>");
  const int catalogue = file.add("<</Type/Catalog/Pages" + reference(pages) + ">>");
  return std::move(file).whole(catalogue);
}

}  // namespace homolog

#include "pictures/page.hpp"

#include "exit_codes.hpp"
#include "pictures/disc_painter.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <algorithm>
#include <cmath>

namespace ricochet::driver {

// Compresses bytes and writes them in base64.
class Page::Packer {
 public:
  explicit Packer(OutputFile& file) : file_(file), out_(3 << 16)
  {
    if (deflateInit(&stream_, Z_DEFAULT_COMPRESSION) != Z_OK)
      throw Failure(Exit::failed, "zlib does not start: not enough memory");
  }
  ~Packer() { deflateEnd(&stream_); }
  Packer(Packer const&) = delete;
  Packer& operator=(Packer const&) = delete;

  void add(std::vector<std::uint8_t>& bytes) { pack(bytes.data(), bytes.size(), Z_NO_FLUSH); }
  void finish() { pack(nullptr, 0, Z_FINISH); }

 private:
  void pack(std::uint8_t* bytes, std::size_t count, int flush)
  {
    stream_.next_in = bytes;
    stream_.avail_in = static_cast<uInt>(count);
    bool is_full = true;
    while (is_full) {
      stream_.next_out = out_.data() + kept_;
      stream_.avail_out = static_cast<uInt>(out_.size() - kept_);
      deflate(&stream_, flush);
      is_full = stream_.avail_out == 0;
      encode(out_.size() - stream_.avail_out, flush == Z_FINISH && !is_full);
    }
  }

  // Three bytes are four characters; what does not fill three waits for more.
  void encode(std::size_t count, bool is_last)
  {
    constexpr char const* digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    std::size_t next = 0;
    for (; next + 3 <= count || (is_last && next < count); next += 3) {
      std::size_t const here = std::min<std::size_t>(count - next, 3);
      unsigned bits = 0;
      for (std::size_t i = 0; i < 3; ++i)
        bits = bits << 8 | (i < here ? out_[next + i] : 0U);
      for (std::size_t i = 0; i < 4; ++i)
        text += i <= here ? digits[bits >> (18 - 6 * i) & 63] : '=';
    }
    file_.write(text);
    kept_ = next < count ? count - next : 0;
    std::copy_n(out_.begin() + static_cast<std::ptrdiff_t>(next), kept_, out_.begin());
  }

  OutputFile& file_;
  z_stream stream_{};
  std::vector<std::uint8_t> out_;
  std::size_t kept_ = 0; ///< at the start of out_, not yet encoded
};

namespace {

constexpr std::string_view frames_place = "<!--frames-->", header_place = "<!--header-->";

std::string_view part(std::size_t begin, std::size_t end)
{
  return std::string_view(page_text).substr(begin, end - begin);
}

// How finely numbers are kept: of a plane 1,000 pixels wide a sixteenth of a pixel, of the scale of
// colours a quarter of a colour.
constexpr int place_steps = (1 << 14) - 1, speed_steps = (1 << 12) - 1;

std::uint16_t quantised(double value, double from, double to, int steps)
{
  double const share = (value - from) / (to - from) * steps;
  return share > 0 ? static_cast<std::uint16_t>(std::lround(std::min<double>(share, steps))) : 0;
}

} // namespace

Page::Page(std::string const& path, Stage const& stage, Look const& look, double fps, bool replace)
  : stage_(stage),
    look_(look),
    fps_(fps),
    file_(path, replace),
    packer_(std::make_unique<Packer>(file_))
{
  // Discs can be a little beyond a wall.
  double const width = stage.box.width / 2 + stage.radius;
  double const height = stage.box.height / 2 + stage.radius;
  range_ = {-width, -height, width, height};
  fastest_ = 4 * top_speed(look, stage);
  before_.resize(3 * static_cast<std::size_t>(stage.discs));
  before_that_ = before_;
  file_.write(part(0, std::string_view(page_text).find(frames_place)));
}

Page::~Page() = default;

void Page::add(double time, std::vector<DiscState> const& discs)
{
  write_frame(discs);
  times_.push_back(time);
  if (!stage_.has_velocities)
    return;
  double kinetic = 0, potential = 0;
  for (DiscState const& d : discs) {
    kinetic += (d.vx * d.vx + d.vy * d.vy) / 2;
    potential += stage_.gravity * (d.y + stage_.box.height / 2);
  }
  kinetic_.push_back(kinetic);
  potential_.push_back(potential);
  total_.push_back(kinetic + potential);
}

// Numbers of 16 bits: of each how far it is from 2 a - b, where b and a were before, first all low
// bytes and then all high ones. Free flight is predicted well, and compresses.
void Page::write_frame(std::vector<DiscState> const& discs)
{
  std::size_t const count = discs.size();
  std::vector<std::uint8_t> bytes(6 * count);
  for (std::size_t i = 0; i < count; ++i) {
    DiscState const& d = discs[i];
    std::uint16_t const now[] = {quantised(d.x, range_.left, range_.right, place_steps),
                                 quantised(d.y, range_.bottom, range_.top, place_steps),
                                 quantised(std::hypot(d.vx, d.vy), 0, fastest_, speed_steps)};
    for (std::size_t c = 0; c < 3; ++c) {
      std::size_t const k = c * count + i;
      unsigned const error = now[c] - 2U * before_[k] + before_that_[k];
      bytes[2 * c * count + i] = static_cast<std::uint8_t>(error & 255);
      bytes[(2 * c + 1) * count + i] = static_cast<std::uint8_t>(error >> 8 & 255);
      before_that_[k] = before_[k];
      before_[k] = now[c];
    }
  }
  packer_->add(bytes);
}

std::string Page::header() const
{
  using Json = nlohmann::ordered_json;
  Layout const layout = arrange(look_, stage_);
  Colouring const how = colouring(look_, stage_);
  Colour const behind = background(look_.style);
  std::vector<int> colours;
  for (Colour const& mapped : colour_map()) {
    Colour const colour = how == Colouring::none ? single_colour(look_.style) : mapped;
    colours.insert(colours.end(), {colour.red, colour.green, colour.blue});
  }
  Json json;
  json["discs"] = stage_.discs;
  json["radius"] = stage_.radius;
  json["box"] = {{"width", stage_.box.width},
                 {"height", stage_.box.height},
                 {"periodic_x", stage_.box.x == Boundary::periodic},
                 {"periodic_y", stage_.box.y == Boundary::periodic}};
  json["plane"] = {{"left", layout.plane.left},
                   {"top", layout.plane.top},
                   {"width", layout.plane.width()},
                   {"height", layout.plane.height()},
                   {"scale", layout.scale},
                   {"origin_x", layout.origin_x - layout.plane.left},
                   {"origin_y", layout.origin_y - layout.plane.top}};
  json["unit"] = layout.unit;
  json["classic"] = look_.style == Style::classic;
  json["range"] = {{"left", range_.left},       {"bottom", range_.bottom},
                   {"right", range_.right},     {"top", range_.top},
                   {"speed", fastest_},         {"place_steps", place_steps},
                   {"speed_steps", speed_steps}};
  json["colouring"] = how == Colouring::speed ? "speed" : how == Colouring::id ? "id" : "none";
  json["top_speed"] = top_speed(look_, stage_);
  json["has_velocities"] = stage_.has_velocities;
  json["background"] = {behind.red, behind.green, behind.blue};
  json["colours"] = colours;
  json["fps"] = fps_;
  json["decimals"] = time_decimals(stage_);
  json["times"] = times_;
  json["energy"] = {{"kinetic", kinetic_}, {"potential", potential_}, {"total", total_}};
  json["what"] = fmt::format("{} discs, {} frames.", stage_.discs, times_.size());
  return json.dump();
}

void Page::finish()
{
  packer_->finish();
  std::string_view const page(page_text);
  std::size_t const frames = page.find(frames_place) + frames_place.size();
  std::size_t const header = page.find(header_place);
  file_.write(part(frames, header));
  file_.write(this->header());
  file_.write(part(header + header_place.size(), page.size()));
  file_.commit();
}

} // namespace ricochet::driver

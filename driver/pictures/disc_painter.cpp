#include "pictures/disc_painter.hpp"

#include "ricochet/spaces.hpp"

#include <algorithm>
#include <cstring>

namespace ricochet::driver {

namespace {

using Space = ParallelSpace;
using Memory = Space::memory_space;

constexpr int tile = 32;   // pixels each way; the ink of a tile fits into the nearest cache
constexpr int full = 4096; // coverage of a pixel that is covered
constexpr float pi = 3.14159265F;

KOKKOS_INLINE_FUNCTION int larger(int a, int b)
{
  return a > b ? a : b;
}

KOKKOS_INLINE_FUNCTION int smaller(int a, int b)
{
  return a < b ? a : b;
}

// `value`, but 0 at least and 1 at most; written so that it takes no branch.
KOKKOS_INLINE_FUNCTION float share(float value)
{
  float const positive = value > 0 ? value : 0;
  return positive < 1 ? positive : 1;
}

constexpr float half = 0.5F;

KOKKOS_INLINE_FUNCTION std::uint32_t rounded(float value)
{
  return static_cast<std::uint32_t>(static_cast<int>(value + half));
}

// A disc as it is seen, in pixels of the plane.
struct Spot {
  float x, y;
  int value; // of its colour
};

// The spots, by the tile of their centre. What is centred outside belongs to the tile at the edge.
struct Spots {
  Kokkos::View<Spot*, Memory> spots;
  Kokkos::View<int*, Memory> begin; // of each tile; the last tile's end behind them
  Kokkos::View<int*, Memory> room;  // what is left for spots while they are placed
  int columns = 0, rows = 0;        // of tiles
};

// Finds where discs are seen, and what they are.
struct Eye {
  Kokkos::View<DiscState const*, Memory> discs;
  Spots tiles;
  int width, height; // pixels
  double scale, origin_x, origin_y;
  double radius;             // pixels
  double period_x, period_y; // pixels; 0: walls
  Colouring colouring;
  double colours_per_value;

  // Calls use(tile, spot) for each place at which `disc` is seen: on periodic axes up to four.
  template <class Use>
  KOKKOS_FUNCTION void look(int disc, Use const& use) const
  {
    DiscState const d = discs(disc);
    double const reach = radius + 1;
    int const ends_x = period_x > 0 ? 1 : 0, ends_y = period_y > 0 ? 1 : 0;
    for (int j = -ends_y; j <= ends_y; ++j)
      for (int i = -ends_x; i <= ends_x; ++i) {
        double const x = origin_x + d.x * scale + i * period_x;
        double const y = origin_y - d.y * scale + j * period_y;
        // What is not a number is not seen.
        if (x > -reach && x < width + reach && y > -reach && y < height + reach) {
          int const column = smaller(larger(static_cast<int>(x), 0) / tile, tiles.columns - 1);
          int const row = smaller(larger(static_cast<int>(y), 0) / tile, tiles.rows - 1);
          use(row * tiles.columns + column,
              Spot{static_cast<float>(x), static_cast<float>(y), value_of(disc, d)});
        }
      }
  }

  KOKKOS_FUNCTION int value_of(int disc, DiscState const& d) const
  {
    double value = 0;
    if (colouring == Colouring::speed)
      value = sqrt(d.vx * d.vx + d.vy * d.vy) * colours_per_value;
    else if (colouring == Colouring::id)
      value = disc * colours_per_value;
    return value < 255 ? static_cast<int>(value) : 255;
  }
};

// Sorts what the eye sees into the tiles. The order in a tile is left to chance: it does not show.
void sort_into_tiles(Eye& eye)
{
  Spots& tiles = eye.tiles;
  int const count = tiles.columns * tiles.rows;
  Kokkos::RangePolicy<Space> const discs(0, static_cast<int>(eye.discs.extent(0)));
  auto const begin = tiles.begin, room = tiles.room;
  Kokkos::deep_copy(room, 0);
  Eye const seen = eye;
  Kokkos::parallel_for(
      "ricochet::count_spots", discs, KOKKOS_LAMBDA(int disc) {
        seen.look(disc, [&](int where, Spot const&) { fetch_add<Space>(room(where), 1); });
      });
  Kokkos::parallel_scan(
      "ricochet::begin_tiles", Kokkos::RangePolicy<Space>(0, count + 1),
      KOKKOS_LAMBDA(int where, int& sum, bool is_final) {
        int const own = where < count ? room(where) : 0;
        if (is_final)
          begin(where) = sum;
        sum += own;
      });
  int total = 0;
  Kokkos::deep_copy(total, Kokkos::subview(begin, count));
  if (tiles.spots.extent(0) < static_cast<std::size_t>(total))
    tiles.spots = uninitialised<decltype(tiles.spots)>("ricochet::spots", total + total / 8);
  auto const spots = tiles.spots;
  Kokkos::parallel_for(
      "ricochet::place_spots", discs, KOKKOS_LAMBDA(int disc) {
        seen.look(disc, [&](int where, Spot const& spot) {
          spots(begin(where) + fetch_add<Space>(room(where), -1) - 1) = spot;
        });
      });
}

// Paints a tile: lets all spots that reach it add to the ink of its pixels, then turns the ink into
// colours.
struct Brush {
  Spots tiles;
  int width, height;
  float radius, rim; // pixels; the rim is the darker edge of a disc
  Colour background;
  Kokkos::View<std::uint8_t* [3], Kokkos::LayoutRight, Memory> colours; // by value
  Kokkos::View<std::uint8_t* [3], Kokkos::LayoutRight, Memory> pixels;

  struct Ink {
    int left, top, right, bottom; // of the tile, in pixels of the plane
    std::uint32_t coverage[tile][tile] = {};
    std::uint32_t light[tile][tile] = {};
    std::uint64_t value[tile][tile] = {}; // times coverage
  };

  KOKKOS_FUNCTION void operator()(int which) const
  {
    int const row = which / tiles.columns, column = which % tiles.columns;
    Ink ink{column * tile, row * tile, smaller((column + 1) * tile, width),
            smaller((row + 1) * tile, height)};
    float const edge = radius + 1;
    float const left = static_cast<float>(ink.left) - edge;
    float const right = static_cast<float>(ink.right) + edge;
    float const top = static_cast<float>(ink.top) - edge;
    float const bottom = static_cast<float>(ink.bottom) + edge;
    int const reach = static_cast<int>(edge) / tile + 1;
    int const first = larger(column - reach, 0), last = smaller(column + reach, tiles.columns - 1);
    for (int r = larger(row - reach, 0); r <= smaller(row + reach, tiles.rows - 1); ++r) {
      // Tiles of a row lie one behind the other.
      int const begin = tiles.begin(r * tiles.columns + first);
      int const end = tiles.begin(r * tiles.columns + last + 1);
      for (int i = begin; i < end; ++i) {
        Spot const spot = tiles.spots(i);
        bool const is_near = spot.x > left && spot.x < right && spot.y > top && spot.y < bottom;
        if (is_near && radius < 0.5F)
          put_point(ink, spot);
        else if (is_near)
          put_disc(ink, spot);
      }
    }
    develop(ink);
  }

  // Coverage falls from 1 to 0 within a pixel at the edge. On the average over all places in a
  // pixel a disc of radius r covers pi (r^2 + 1/12) so; hence the smaller radius.
  KOKKOS_FUNCTION void put_disc(Ink& ink, Spot const& spot) const
  {
    float const edge = sqrt(radius * radius - 1.0F / 12) + 0.5F;
    int const left = larger(ink.left, static_cast<int>(floor(spot.x - edge)));
    int const right = smaller(ink.right, static_cast<int>(floor(spot.x + edge)) + 1);
    int const top = larger(ink.top, static_cast<int>(floor(spot.y - edge)));
    int const bottom = smaller(ink.bottom, static_cast<int>(floor(spot.y + edge)) + 1);
    for (int y = top; y < bottom; ++y) {
      float const dy = static_cast<float>(y) + 0.5F - spot.y;
      for (int x = left; x < right; ++x) {
        float const dx = static_cast<float>(x) + 0.5F - spot.x;
        float const inside = edge - sqrt(dx * dx + dy * dy);
        add(ink, x, y, share(inside), share(inside - rim), spot.value);
      }
    }
  }

  // A disc smaller than a pixel: its area, shared by the four pixels around.
  KOKKOS_FUNCTION void put_point(Ink& ink, Spot const& spot) const
  {
    float const area = pi * radius * radius;
    int const left = static_cast<int>(floor(spot.x - 0.5F));
    int const top = static_cast<int>(floor(spot.y - 0.5F));
    for (int y = larger(top, ink.top); y < smaller(top + 2, ink.bottom); ++y)
      for (int x = larger(left, ink.left); x < smaller(left + 2, ink.right); ++x) {
        float const part = area * (1 - fabs(static_cast<float>(x) + 0.5F - spot.x)) *
                           (1 - fabs(static_cast<float>(y) + 0.5F - spot.y));
        add(ink, x, y, part, part, spot.value);
      }
  }

  static KOKKOS_FUNCTION void add(Ink& ink, int x, int y, float coverage, float bright, int value)
  {
    auto const covered = rounded(coverage * full);
    auto const lit = rounded((coverage + bright) * half * full);
    ink.coverage[y - ink.top][x - ink.left] += covered;
    ink.light[y - ink.top][x - ink.left] += lit;
    ink.value[y - ink.top][x - ink.left] += covered * static_cast<std::uint64_t>(value);
  }

  KOKKOS_FUNCTION void develop(Ink const& ink) const
  {
    Colour const behind = background;
    std::uint8_t const* const map = colours.data();
    for (int y = ink.top; y < ink.bottom; ++y) {
      std::uint8_t* pixel = &pixels(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                        static_cast<std::size_t>(ink.left),
                                    0);
      for (int x = 0; x < ink.right - ink.left; ++x, pixel += 3) {
        std::uint32_t const covered = ink.coverage[y - ink.top][x];
        if (covered == 0) {
          pixel[0] = behind.red;
          pixel[1] = behind.green;
          pixel[2] = behind.blue;
          continue;
        }
        // Half a unit more, so that rounding does not make a whole number less.
        double const per_coverage = 1.0 / covered;
        auto const value = static_cast<std::size_t>(
            (static_cast<double>(ink.value[y - ink.top][x]) + 0.5) * per_coverage);
        auto const light = static_cast<int>((ink.light[y - ink.top][x] + 0.5) * per_coverage * 256);
        int const dense = static_cast<int>(covered < full ? covered : full);
        std::uint8_t const* const colour = map + 3 * value;
        pixel[0] = mixed(colour[0] * light, behind.red, dense);
        pixel[1] = mixed(colour[1] * light, behind.green, dense);
        pixel[2] = mixed(colour[2] * light, behind.blue, dense);
      }
    }
  }

  // `lit`: 256 times a colour.
  static KOKKOS_FUNCTION std::uint8_t mixed(int lit, int behind, int dense)
  {
    return static_cast<std::uint8_t>(
        static_cast<unsigned>((lit >> 8) * dense + behind * (full - dense)) / full);
  }
};

} // namespace

struct DiscPainter::Work {
  Rectangle plane;
  Eye eye;
  Brush brush;
};

DiscPainter::DiscPainter(Stage const& stage, Look const& look, Layout const& layout)
  : work_(std::make_unique<Work>())
{
  Rectangle const plane = layout.plane;
  Colouring const how = driver::colouring(look, stage);
  double const radius = stage.radius * layout.scale;
  work_->plane = plane;

  Eye& eye = work_->eye;
  eye.width = plane.width();
  eye.height = plane.height();
  eye.scale = layout.scale;
  eye.origin_x = layout.origin_x - plane.left;
  eye.origin_y = layout.origin_y - plane.top;
  eye.radius = radius;
  eye.period_x = stage.box.x == Boundary::periodic ? stage.box.width * layout.scale : 0;
  eye.period_y = stage.box.y == Boundary::periodic ? stage.box.height * layout.scale : 0;
  eye.colouring = how;
  eye.colours_per_value =
      how == Colouring::speed
          ? 256 / top_speed(look, stage)
          : 255.0 / static_cast<double>(std::max<std::int64_t>(stage.discs - 1, 1));
  eye.tiles.columns = (eye.width + tile - 1) / tile;
  eye.tiles.rows = (eye.height + tile - 1) / tile;
  int const tiles = eye.tiles.columns * eye.tiles.rows;
  eye.tiles.begin = decltype(eye.tiles.begin)("ricochet::tile_begin", tiles + 1);
  eye.tiles.room = decltype(eye.tiles.room)("ricochet::tile_room", tiles);

  Brush& brush = work_->brush;
  brush.width = eye.width;
  brush.height = eye.height;
  brush.radius = static_cast<float>(radius);
  brush.rim = look.style == Style::classic
                  ? 0
                  : static_cast<float>(std::min(0.12 * radius, 2.5 * layout.unit));
  brush.background = background(look.style);
  brush.pixels =
      decltype(brush.pixels)("ricochet::pixels", static_cast<std::size_t>(eye.width) *
                                                     static_cast<std::size_t>(eye.height));
  brush.colours = decltype(brush.colours)("ricochet::colours", colour_map().size());
  auto const colours = Kokkos::create_mirror_view(brush.colours);
  for (std::size_t i = 0; i < colour_map().size(); ++i) {
    Colour const colour = how == Colouring::none ? single_colour(look.style) : colour_map()[i];
    colours(i, 0) = colour.red;
    colours(i, 1) = colour.green;
    colours(i, 2) = colour.blue;
  }
  Kokkos::deep_copy(brush.colours, colours);
}

DiscPainter::~DiscPainter() = default;

void DiscPainter::paint(std::vector<DiscState> const& discs, Picture& picture)
{
  using Given =
      Kokkos::View<DiscState const*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>;
  Eye& eye = work_->eye;
  Brush& brush = work_->brush;
  eye.discs = Kokkos::create_mirror_view_and_copy(Memory(), Given(discs.data(), discs.size()),
                                                  "ricochet::painted_discs");
  sort_into_tiles(eye);
  brush.tiles = eye.tiles;
  using Tiles = Kokkos::RangePolicy<Space, Kokkos::Schedule<Kokkos::Dynamic>>;
  int const tiles = eye.tiles.columns * eye.tiles.rows;
  Kokkos::parallel_for("ricochet::paint_tiles", Tiles(0, tiles), brush);
  auto const copy = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), brush.pixels);
  Kokkos::fence();
  eye.discs = {};

  auto const row_bytes = static_cast<std::size_t>(eye.width) * 3;
  for (int y = 0; y < eye.height; ++y)
    std::memcpy(picture.row(work_->plane.left, work_->plane.top + y),
                copy.data() + static_cast<std::size_t>(y) * row_bytes, row_bytes);
}

Colour background(Style style)
{
  return style == Style::classic ? Colour{0, 0, 0} : Colour{255, 255, 255};
}

Colour single_colour(Style style)
{
  return style == Style::classic ? Colour{255, 0, 0} : colour_map()[100];
}

} // namespace ricochet::driver

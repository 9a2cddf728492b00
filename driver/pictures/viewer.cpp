#include "pictures/viewer.hpp"

#include "pictures/frame_source.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::driver {

namespace {

using Seconds = std::chrono::duration<double>;

constexpr double forever = 3600; // seconds; then one looks again

} // namespace

View::View(Stage const& stage, Look const& look)
  : stage_(stage), first_(look), look_(look), painter_(std::make_unique<FramePainter>(stage, look))
{
  // From now on a change of the region leaves the window as it is.
  first_.size = look_.size = PictureSize{layout().width, layout().height};
}

bool View::obey(Input const& input)
{
  Region const r = region(look_, stage_);
  Layout const& l = layout();
  if (input.kind == Input::Kind::whole) {
    look_.region = first_.region;
  } else if (input.kind == Input::Kind::zoom) {
    double const x = (input.x - l.origin_x) / l.scale, y = (l.origin_y - input.y) / l.scale;
    auto const nearer = [&](double place, double fixed) {
      return fixed + (place - fixed) / input.factor;
    };
    look_.region =
        Region{nearer(r.left, x), nearer(r.bottom, y), nearer(r.right, x), nearer(r.top, y)};
  } else if (input.kind == Input::Kind::move) {
    double const x = input.x / l.scale, y = input.y / l.scale;
    look_.region = Region{r.left - x, r.bottom + y, r.right - x, r.top + y};
  } else if (input.kind == Input::Kind::colours) {
    Colouring const now = colouring(look_, stage_);
    look_.colouring = now == Colouring::speed ? Colouring::id
                      : now == Colouring::id  ? Colouring::none
                      : stage_.has_velocities ? Colouring::speed
                                              : Colouring::id;
  } else {
    return false;
  }
  painter_ = std::make_unique<FramePainter>(stage_, look_);
  return true;
}

void play(FrameSource& source, std::vector<std::int64_t> const& frames, Look const& look,
          double fps, Window& window)
{
  View view(source.stage(), look);
  std::vector<DiscState> discs;
  auto const last = static_cast<std::int64_t>(frames.size()) - 1;
  std::int64_t at = 0, shown = -1;
  bool is_playing = true, is_changed = true;
  double speed = 1;
  auto next = std::chrono::steady_clock::now();
  for (;;) {
    if (is_changed) {
      if (shown != at)
        source.read(frames[static_cast<std::size_t>(at)], discs);
      shown = at;
      window.show(view.paint(source.time(frames[static_cast<std::size_t>(at)]), discs));
      is_changed = false;
    }
    auto const now = std::chrono::steady_clock::now();
    is_playing = is_playing && at < last;
    if (is_playing && now >= next) {
      // What was too slow to be shown is not made up for.
      next = std::max(next, now) +
             std::chrono::duration_cast<std::chrono::nanoseconds>(Seconds(1 / (fps * speed)));
      ++at;
      is_changed = true;
      continue;
    }
    double const wait = is_playing ? Seconds(next - now).count() : forever;
    std::int64_t to = at;
    for (Input const& input : window.inputs(wait)) {
      switch (input.kind) {
      case Input::Kind::quit:
        return;
      case Input::Kind::play:
        is_playing = !is_playing;
        to = is_playing && to == last ? 0 : to; // once more
        break;
      case Input::Kind::forward:
        is_playing = false;
        ++to;
        break;
      case Input::Kind::back:
        is_playing = false;
        --to;
        break;
      case Input::Kind::first:
        to = 0;
        break;
      case Input::Kind::last:
        to = last;
        break;
      case Input::Kind::ahead:
        to += last / 10 + 1;
        break;
      case Input::Kind::behind:
        to -= last / 10 + 1;
        break;
      case Input::Kind::faster:
        speed *= 2;
        break;
      case Input::Kind::slower:
        speed /= 2;
        break;
      default:
        is_changed = view.obey(input) || is_changed;
      }
      to = std::clamp<std::int64_t>(to, 0, last);
    }
    is_changed = is_changed || to != at;
    at = to;
  }
}

LiveView::LiveView(std::unique_ptr<Window> window, View view, double pace)
  : window_(std::move(window)), view_(std::move(view)), pace_(pace)
{
}

bool LiveView::is_due() const
{
  return window_ && Clock::now() >= next_;
}

void LiveView::show(double time, std::vector<DiscState> const& discs)
{
  bool is_paused = false;
  for (bool is_shown = false; window_;) {
    double const wait = is_paused ? forever : std::max(0.0, Seconds(next_ - Clock::now()).count());
    for (Input const& input : window_->inputs(wait)) {
      if (input.kind == Input::Kind::quit) {
        window_.reset();
        return;
      }
      if (input.kind == Input::Kind::play)
        is_paused = !is_paused;
      else if (view_.obey(input))
        is_shown = false;
    }
    if (!is_shown)
      window_->show(view_.paint(time, discs));
    is_shown = true;
    if (!is_paused && Clock::now() >= next_)
      break;
  }
  next_ = std::max(next_ + std::chrono::duration_cast<Clock::duration>(pace_), Clock::now());
}

} // namespace ricochet::driver

// In a build with SDL2.
#include "exit_codes.hpp"
#include "pictures/window.hpp"

#include <SDL.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <optional>

namespace ricochet::driver {

namespace {

[[noreturn]] void fail()
{
  throw Failure(Exit::failed, fmt::format("cannot open a window: {}", SDL_GetError()));
}

std::optional<Input::Kind> meaning(SDL_Keycode key)
{
  switch (key) {
  case SDLK_q:
  case SDLK_ESCAPE:
    return Input::Kind::quit;
  case SDLK_SPACE:
    return Input::Kind::play;
  case SDLK_RIGHT:
    return Input::Kind::forward;
  case SDLK_LEFT:
    return Input::Kind::back;
  case SDLK_HOME:
    return Input::Kind::first;
  case SDLK_END:
    return Input::Kind::last;
  case SDLK_PAGEDOWN:
    return Input::Kind::ahead;
  case SDLK_PAGEUP:
    return Input::Kind::behind;
  case SDLK_UP:
    return Input::Kind::faster;
  case SDLK_DOWN:
    return Input::Kind::slower;
  case SDLK_c:
    return Input::Kind::colours;
  case SDLK_w:
    return Input::Kind::whole;
  default:
    return std::nullopt;
  }
}

template <class T, void (*destroy)(T*)>
struct Destroy {
  void operator()(T* thing) const { destroy(thing); }
};

class SdlWindow : public Window {
 public:
  SdlWindow(std::string const& title, int width, int height)
  {
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    if (SDL_Init(SDL_INIT_VIDEO) != 0)
      fail();
    // Without a screen SDL takes its driver that draws for nobody; that must be asked for.
    if (std::string(SDL_GetCurrentVideoDriver()) == "offscreen" && !std::getenv("SDL_VIDEODRIVER"))
      throw Failure(Exit::failed, "cannot open a window: there is no screen (DISPLAY is not set)");
    SDL_StopTextInput(); // keys are keys; no input method is asked what they mean
    window_.reset(SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED,
                                   width, height, 0));
    if (!window_)
      fail();
    renderer_.reset(SDL_CreateRenderer(window_.get(), -1, SDL_RENDERER_SOFTWARE));
    if (!renderer_)
      fail();
    texture_.reset(SDL_CreateTexture(renderer_.get(), SDL_PIXELFORMAT_RGB24,
                                     SDL_TEXTUREACCESS_STREAMING, width, height));
    if (!texture_)
      fail();
  }
  ~SdlWindow() override
  {
    texture_.reset();
    renderer_.reset();
    window_.reset();
    SDL_Quit();
  }
  SdlWindow(SdlWindow const&) = delete;
  SdlWindow& operator=(SdlWindow const&) = delete;

  void show(Picture const& picture) override
  {
    SDL_UpdateTexture(texture_.get(), nullptr, picture.bytes().data(), picture.width() * 3);
    present();
  }

  std::vector<Input> inputs(double seconds) override
  {
    std::vector<Input> found;
    SDL_Event event;
    bool is_there = SDL_WaitEventTimeout(&event, static_cast<int>(std::ceil(seconds * 1000))) != 0;
    for (; is_there; is_there = SDL_PollEvent(&event) != 0)
      add(event, found);
    return found;
  }

 private:
  void present()
  {
    SDL_RenderCopy(renderer_.get(), texture_.get(), nullptr, nullptr);
    SDL_RenderPresent(renderer_.get());
  }

  void add(SDL_Event const& event, std::vector<Input>& found)
  {
    if (event.type == SDL_QUIT) {
      found.push_back({Input::Kind::quit});
    } else if (event.type == SDL_KEYDOWN) {
      if (auto const kind = meaning(event.key.keysym.sym))
        found.push_back({*kind});
    } else if (event.type == SDL_MOUSEWHEEL) {
      int x = 0, y = 0;
      SDL_GetMouseState(&x, &y);
      found.push_back({Input::Kind::zoom, 1.0 * x, 1.0 * y, std::pow(1.25, event.wheel.y)});
    } else if (event.type == SDL_MOUSEMOTION && (event.motion.state & SDL_BUTTON_LMASK) != 0) {
      found.push_back({Input::Kind::move, 1.0 * event.motion.xrel, 1.0 * event.motion.yrel});
    } else if (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_EXPOSED) {
      present();
    }
  }

  std::unique_ptr<SDL_Window, Destroy<SDL_Window, SDL_DestroyWindow>> window_;
  std::unique_ptr<SDL_Renderer, Destroy<SDL_Renderer, SDL_DestroyRenderer>> renderer_;
  std::unique_ptr<SDL_Texture, Destroy<SDL_Texture, SDL_DestroyTexture>> texture_;
};

} // namespace

bool has_window()
{
  return true;
}

std::unique_ptr<Window> open_window(std::string const& title, int width, int height)
{
  return std::make_unique<SdlWindow>(title, width, height);
}

} // namespace ricochet::driver

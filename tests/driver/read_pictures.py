#!/usr/bin/env python3
"""Plays what `ricochet render` makes: movies with ffprobe and ffmpeg, plots with gnuplot, the
window in Xvfb, the page in Chromium.

Usage: read_pictures.py RICOCHET SCENES_FOLDER [FOLDER_FOR_SCREENSHOTS]
"""
import base64
import io
import json
import os
import subprocess
import sys
import tempfile
import time
from xml.etree import ElementTree

import numpy as np
from PIL import Image
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

SIZE = (480, 360)


def run(program, *arguments):
    quiet = [] if arguments[0] == "plot" else ["--quiet"]
    subprocess.run([program, *arguments, *quiet], check=True)


def pixels(png):
    return np.asarray(Image.open(png).convert("RGB"), dtype=float)


def check_movies(program, trajectory, folder):
    for name, codec, formats in (("m.mp4", "h264", ["yuv420p"]), ("m.gif", "gif", ["bgra", "pal8"])):
        path = os.path.join(folder, name)
        run(program, "render", trajectory, "-o", path, "--size", "%dx%d" % SIZE, "--fps", "25")
        found = json.loads(subprocess.run(
            ["ffprobe", "-v", "error", "-select_streams", "v:0", "-count_frames", "-show_entries",
             "stream=codec_name,width,height,pix_fmt,r_frame_rate,nb_read_frames", "-of", "json", path],
            check=True, capture_output=True).stdout)["streams"][0]
        print(name, found)
        assert found["codec_name"] == codec and found["pix_fmt"] in formats, found
        assert (found["width"], found["height"]) == SIZE
        assert found["nb_read_frames"] == "31" and found["r_frame_rate"] == "25/1"

        # Frame 20 of the movie is picture 20. Encoding blurs edges, hence the mean.
        still, frame = (os.path.join(folder, n) for n in ("still.png", "frame.png"))
        run(program, "render", trajectory, "-o", still, "--frame", "20", "--size", "%dx%d" % SIZE, "--force")
        subprocess.run(["ffmpeg", "-v", "error", "-y", "-i", path, "-vf", "select=eq(n\\,20)", "-frames:v", "1",
                        frame], check=True)
        difference = np.abs(pixels(still) - pixels(frame)).mean()
        other = os.path.join(folder, "other.png")
        run(program, "render", trajectory, "-o", other, "--frame", "21", "--size", "%dx%d" % SIZE, "--force")
        print(f"  frame 20: {difference:.2f} of 255 on the average; frame 21 would be "
              f"{np.abs(pixels(other) - pixels(frame)).mean():.2f}")
        assert difference < 0.5 * np.abs(pixels(other) - pixels(frame)).mean()


def check_plots(program, trajectory, folder):
    png, svg = (os.path.join(folder, name) for name in ("p.png", "p.svg"))
    run(program, "plot", trajectory, "-o", png)
    run(program, "plot", trajectory, "-o", svg)
    assert Image.open(png).size == (1500, 1100)
    text = ElementTree.parse(svg).getroot().itertext()
    titles = [t.strip() for t in text]
    for title in ("energy", "energy ledger", "temperature", "pressure pV/NT", "collisions so far",
                  "speeds, later half", "Maxwell", "packing by height, later half", "g(r), later half"):
        assert title in titles, (title, titles)


def check_window(program, trajectory, folder, screenshot):
    """Keys pressed in a real window, and what is on the screen then."""
    screen = os.path.join(folder, "screen.png")
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "800x640x24"], pass_fds=[write],
                              stderr=subprocess.DEVNULL)
    display = ":" + os.read(read, 16).decode().strip()
    environment = dict(os.environ, DISPLAY=display)
    environment.pop("SDL_VIDEODRIVER", None)
    viewer = subprocess.Popen([program, "render", trajectory, "--window", "--size", "800x640", "--fps", "1000"],
                              env=environment)
    try:
        def tool(*words):
            return subprocess.run(["xdotool", *words], env=environment, check=True, capture_output=True).stdout

        def until_screen_shows(frame, *look):
            still = os.path.join(folder, "still.png")
            run(program, "render", trajectory, "-o", still, "--frame", str(frame), "--size", "800x640", "--force", *look)
            for _ in range(100):
                subprocess.run(["ffmpeg", "-v", "error", "-y", "-f", "x11grab", "-draw_mouse", "0", "-video_size", "800x640", "-i", display,
                                "-frames:v", "1", screen], check=True)
                if (pixels(screen) == pixels(still)).all():
                    return print(f"  window: frame {frame} {' '.join(look)}")
                time.sleep(0.1)
            raise AssertionError(f"the window does not show frame {frame} {look}")

        tool("search", "--sync", "--onlyvisible", "--name", "walls.h5md", "windowmove", "--sync", "0", "0")
        until_screen_shows(30)  # it has played to the end
        for keys, frame, look in ((["Home", "Right", "Right"], 2, []), (["Left"], 1, []), (["Next"], 5, []),
                                  (["c"], 5, ["--colour", "id"]), (["c", "End"], 30, ["--colour", "none"])):
            tool("key", *keys)
            until_screen_shows(frame, *look)
        tool("mousemove", "200", "300", "click", "4")  # the wheel
        time.sleep(1)
        tool("key", "w", "Home", "Right")
        until_screen_shows(1, "--colour", "none")
        if screenshot:
            os.replace(screen, screenshot)
        tool("key", "q")
        assert viewer.wait(timeout=30) == 0
    finally:
        viewer.kill()
        viewer.wait()
        server.terminate()
        server.wait()


def browser():
    options = webdriver.ChromeOptions()
    # No sandbox, as containers run everything as root; no network, as the page must need none.
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1300,1300",
                     "--proxy-server=127.0.0.1:9", "--force-device-scale-factor=1"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options)


def canvas(driver):
    url = driver.execute_script("return canvas.toDataURL('image/png')")
    return pixels(io.BytesIO(base64.b64decode(url.split(",")[1])))


def check_page(driver, program, scene, options, folder, screenshot):
    page, still = os.path.join(folder, "p.html"), os.path.join(folder, "still.png")
    look = ["--size", "800x640", *options]
    run(program, "render", scene, "--html", page, "--force", *look)
    print(f"{os.path.basename(scene)} {' '.join(options)}: {os.path.getsize(page)} bytes")
    driver.get("file://" + page)
    driver.set_script_timeout(60)
    assert driver.execute_async_script("player.ready.then(() => arguments[0]('ready'), e => arguments[0]('' + e))") == "ready"
    header = driver.execute_script("return player.header")
    frames = len(header["times"])

    # The picture of a frame is that of the renderer, but for quantised places: 0.03 of a pixel each
    # way change a pixel at an edge by 0.04 * 255 = 11, and two such edges may meet in one.
    plane = header["plane"]
    for frame in (0, frames // 2, frames - 1):
        driver.execute_script("player.show(arguments[0])", frame)
        run(program, "render", scene, "-o", still, "--frame", str(frame), "--force", *look)
        theirs = canvas(driver)
        ours = pixels(still)[plane["top"]:plane["top"] + plane["height"], plane["left"]:plane["left"] + plane["width"]]
        difference = np.abs(ours - theirs)
        print(f"  frame {frame}: {difference.mean():.3f} of 255 on the average, {difference.max():.0f} at most")
        assert difference.mean() < 0.5 and difference.max() < 24, frame
        assert (theirs != theirs[0, 0]).any()

    # Seeking with the slider and the keys.
    driver.execute_script("const s = document.getElementById('seek'); s.value = 3; s.dispatchEvent(new Event('input'))")
    assert driver.execute_script("return player.frame") == 3
    at_3 = canvas(driver)
    driver.find_element(By.TAG_NAME, "body").send_keys(Keys.ARROW_RIGHT)
    assert driver.execute_script("return player.frame") == 4
    assert (canvas(driver) != at_3).any()
    assert driver.find_element(By.ID, "time").text == f"t = {header['times'][4]:.{header['decimals']}f}"

    # Playing, to the end.
    driver.find_element(By.ID, "play").click()
    assert driver.execute_script("return player.playing")
    deadline = time.time() + 60
    while driver.execute_script("return player.playing") and time.time() < deadline:
        time.sleep(0.05)
    assert driver.execute_script("return player.frame") == frames - 1
    assert driver.find_element(By.ID, "play").text == "play"

    # Zooming enlarges: the disc that is pointed at stays under the mouse, which tells what it is.
    driver.execute_script("player.show(0)")
    before = canvas(driver)
    x, y = driver.execute_script("return [view.x + place_x(0) * view.scale, view.y - place_y(0) * view.scale]")
    driver.execute_script("player.zoom({x: arguments[0], y: arguments[1]}, 3)", x, y)
    assert (canvas(driver) != before).any()
    element = driver.find_element(By.ID, "discs")
    ActionChains(driver).move_to_element_with_offset(
        element, round(x - element.size["width"] / 2), round(y - element.size["height"] / 2)).perform()
    told = driver.find_element(By.ID, "hover").text
    assert told.startswith("disc 0\nspeed "), told
    speed = driver.execute_script("return speed_of(0)")
    assert abs(float(told.split()[-1]) - speed) <= 0.01 * speed
    if screenshot:
        driver.save_screenshot(screenshot)
    driver.execute_script("view = {...home}; player.show(0)")
    assert (canvas(driver) == before).all()

    problems = [entry for entry in driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
    assert not problems, problems


def main():
    program, scenes = sys.argv[1:3]
    screenshots = sys.argv[3] if len(sys.argv) > 3 else None
    with tempfile.TemporaryDirectory() as folder:
        walls, periodic = (os.path.join(folder, name) for name in ("walls.h5md", "periodic.h5md"))
        run(program, "run", os.path.join(scenes, "gas_2000.csv"), os.path.join(scenes, "gas_2000.config.csv"),
            "-o", walls, "--steps", "90", "--every", "3")
        run(program, "run", os.path.join(scenes, "gas.toml"), "-o", periodic, "--duration", "8",
            "--set", "run.measure_from=0", "--every-time", "0.5")
        check_movies(program, walls, folder)
        check_plots(program, walls, folder)
        check_window(program, walls, folder, os.path.join(screenshots, "window.png") if screenshots else None)
        driver = browser()
        try:
            for name, trajectory, options in (("walls", walls, []), ("periodic", periodic, ["--colour", "id"])):
                shot = os.path.join(screenshots, name + ".png") if screenshots else None
                check_page(driver, program, trajectory, options, folder, shot)
        finally:
            driver.quit()


if __name__ == "__main__":
    main()

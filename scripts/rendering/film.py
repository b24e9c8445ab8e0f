"""A film of pictures, by ffmpeg."""
import subprocess
import sys
import tempfile
from pathlib import Path

EVEN = "scale=trunc(iw/2)*2:trunc(ih/2)*2"  # both codecs want even sizes
CODECS = {".mp4": ["-vf", EVEN, "-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart"],
          ".webm": ["-vf", EVEN, "-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-pix_fmt", "yuv420p"],
          ".gif": ["-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse"]}


def frame_rate(times, speed):
    """Of pictures on the screen, Hz; the film takes as long as the run if `speed` is 1."""
    return speed * (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 else 1.0


def make_film(scene, path, speed):
    with tempfile.TemporaryDirectory() as folder:
        for k, time in enumerate(scene.times):
            scene.draw(time, Path(folder) / f"{k:06}.png")
        command = ["ffmpeg", "-y", "-loglevel", "error", "-framerate", f"{frame_rate(scene.times, speed):.6g}",
                   "-i", f"{folder}/%06d.png", *CODECS[path.suffix], str(path)]
        done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              text=True)
    if done.returncode != 0:
        sys.exit(f"render: {path}: ffmpeg could not make the film: {done.stderr.strip()}")

"""Links in the documents are written for the repository. In the site a link to a page that is not in it (a source file,
a folder) becomes the text that it stands on, and one to a folder with a page leads to that page."""

import os
import re

IMAGE = re.compile(r'<img src="([^"]+)"[^>]*alt="([^"]*)"[^>]*>')
LINK = re.compile(r"(?<!!)\[((?:[^\[\]]|!\[[^\]]*\]\([^)]*\))*)\]\(([^)\s]+)\)")


def target_of(link, folder, root):
    """The link as the site can follow it, or None where it cannot."""
    if re.match(r"[a-z]+:", link) or link.startswith("#"):
        return link
    path, _, anchor = link.partition("#")
    file = os.path.normpath(os.path.join(folder, path))
    if os.path.isdir(os.path.join(root, file)):
        file, path = os.path.join(file, "README.md"), path.rstrip("/") + "/README.md"
    if file == os.path.join("docs", "README.md"):
        return "/index.md"
    if file.endswith(".ipynb"):  # stands in the site as the document that it was made into
        file, path = file[:-6] + ".md", path[:-6] + ".md"
    if file.startswith("..") or not os.path.isfile(os.path.join(root, file)):
        return None
    return path + ("#" + anchor if anchor else "")


def adapt(app, name, source):
    """Of one document, outside of its blocks of code."""
    folder = os.path.dirname(name)

    def replaced(match):
        target = target_of(match[2], folder, app.srcdir)
        return match[1] if target is None else "[%s](%s)" % (match[1], target)

    lines, fence = [], None
    for line in re.split(r"(?<=\n)", source[0]):
        mark = re.match(r"\s*(```+|~~~+)", line)
        if mark and (fence is None or mark[1].startswith(fence)):
            fence = None if fence else mark[1]
            lines.append(line)
        elif fence:
            lines.append(line)
        else:
            lines.append(("text", line))
    out, block = [], ""
    for line in lines + [""]:
        if isinstance(line, tuple):
            block += line[1]
            continue
        out.append(LINK.sub(replaced, IMAGE.sub(r"![\2](\1)", block)))
        out.append(line)
        block = ""
    source[0] = "".join(out)

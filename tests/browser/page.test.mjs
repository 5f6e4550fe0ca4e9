// report.html in Chromium: what no test of its data can see. Run by tests/browser.sh.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const root = join(import.meta.dirname, "..", "..");
const out = mkdtempSync(join(tmpdir(), "fit-cloth-page-"));
const program = process.env.FIT_CLOTH ?? join(root, "target", "debug", "fit-cloth");
const run = (name, ...options) => {
  execFileSync(program, [...options, "--quiet", "--out", join(out, name)], { cwd: root, stdio: ["ignore", "inherit", "inherit"] });
};
// A software renderer: there is no screen.
const args = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];
let browser;

before(async () => {
  run("fit", "fit", "fixtures/cotton-denim");
  run("models", "fit", "fixtures/rayon-spandex-knit", "--model", "all", "--nodes", "13x13");
  run("compared", "compare", "fixtures/cotton-satin", "--nodes", "9x9");
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
});

after(async () => {
  await browser?.close();
  rmSync(out, { recursive: true, force: true });
});

// A page that complains, or asks for anything beside itself, fails.
async function open(name, width, scheme = "light") {
  const page = await browser.newPage({ viewport: { width, height: 900 }, colorScheme: scheme });
  const complaints = [], requests = [];
  page.on("console", (message) => complaints.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("request", (request) => requests.push(request.url()));
  const url = pathToFileURL(join(out, name, "report.html")).href;
  await page.goto(url);
  await page.locator("#summary td").first().waitFor();
  const close = async () => {
    assert.deepEqual(complaints, []);
    assert.deepEqual(requests, [url]);
    await page.close();
  };
  return { page, close };
}

// What a canvas shows: how many of its pixels are not of the commonest colour, how many colours, and a small copy.
function pixels(page, selector) {
  return page.locator(selector).first().evaluate((canvas) => {
    const read = (width, height) => {
      const copy = Object.assign(document.createElement("canvas"), { width, height });
      const context = copy.getContext("2d");
      context.drawImage(canvas, 0, 0, width, height);
      return context.getImageData(0, 0, width, height).data;
    };
    const data = read(canvas.width, canvas.height), counts = new Map();
    for (let i = 0; i < data.length; i += 4) {
      const colour = `${data[i]},${data[i + 1]},${data[i + 2]},${data[i + 3]}`;
      counts.set(colour, (counts.get(colour) ?? 0) + 1);
    }
    const drawn = data.length / 4 - Math.max(...counts.values());
    return { drawn, width: canvas.width, colours: counts.size, counts: Object.fromEntries(counts), small: [...read(64, 32)] };
  });
}

// How many of the small copies' values differ. Not to the last bit: a renderer on several threads does not draw lines that
// cross twice alike.
const difference = (a, b) => a.small.filter((value, i) => Math.abs(value - b.small[i]) > 6).length;
const differ = (a, b) => assert.ok(difference(a, b) > 10, `only ${difference(a, b)} values differ`);

const frameOf = (page) => page.locator("#which").textContent();
const rows = (path) => {
  const [header, ...lines] = readFileSync(path, "utf8").trim().split("\n").map((line) => line.split(","));
  return lines.map((line) => Object.fromEntries(line.map((cell, i) => [header[i], cell])));
};

for (const width of [1280, 390]) {
  describe(`a fit, ${width} pixels wide`, () => {
    test("nothing is wider than the page", async () => {
      const { page, close } = await open("fit", width);
      const [scroll, client] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
      assert.ok(scroll <= client, `${scroll} > ${client}`);
      await close();
    });

    test("every curve, force, profile and the convergence is drawn", async () => {
      const { page, close } = await open("fit", width);
      for (const curve of await page.locator("#components button").all()) {
        await curve.click();
        // A line right across, in the model's own colour; the band's is paler.
        const { counts, width: across } = await pixels(page, "#curve canvas");
        const line = counts["0,114,178,255"];
        assert.ok(line > 1.2 * across, `${await curve.textContent()}: ${line} pixels on ${across}`);
        assert.ok((await pixels(page, "#histogram canvas")).drawn > 300);
      }
      for (const name of await page.locator("#sequence option").allTextContents()) {
        await page.locator("#sequence").selectOption(name);
        if (name.startsWith("bend")) {
          // Six frames, simulated and measured.
          assert.equal(await page.locator("#answer polyline").count(), 12);
        } else {
          assert.ok((await pixels(page, "#answer canvas")).drawn > 1000);
        }
      }
      assert.ok((await pixels(page, "#convergence canvas")).drawn > 1000);
      await close();
    });

    test("the slider changes the frame, and the picture", async () => {
      const { page, close } = await open("fit", width);
      const [first, before] = [await frameOf(page), await pixels(page, "#view")];
      assert.ok(before.drawn > 5000 && before.colours > 100, `${before.drawn} pixels, ${before.colours} colours`);
      await page.locator("#frame").fill("0");
      const after = await pixels(page, "#view");
      assert.notEqual(await frameOf(page), first);
      differ(after, before);
      await close();
    });

    test("the sheet is turned with the pointer and the keys", async () => {
      const { page, close } = await open("fit", width);
      const view = page.locator("#view");
      const before = await pixels(page, "#view");
      await view.scrollIntoViewIfNeeded();
      const box = await view.boundingBox();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      await page.mouse.down();
      await page.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2 + 20);
      await page.mouse.up();
      const dragged = await pixels(page, "#view");
      differ(dragged, before);
      await view.focus();
      await page.keyboard.press("ArrowLeft");
      const turned = await pixels(page, "#view");
      differ(turned, dragged);
      await page.keyboard.press("+");
      assert.ok((await pixels(page, "#view")).drawn > turned.drawn);
      await page.keyboard.press("0");
      assert.ok(difference(await pixels(page, "#view"), before) < 4);
      await close();
    });

    test("keys change the frame, play, and zoom a chart", async () => {
      const { page, close } = await open("fit", width);
      await page.locator("#view").focus();
      const first = await frameOf(page);
      await page.keyboard.press(".");
      assert.notEqual(await frameOf(page), first);
      await page.keyboard.press(",");
      assert.equal(await frameOf(page), first);
      await page.keyboard.press(" ");
      await page.waitForFunction((was) => document.getElementById("which").textContent !== was, first);
      await page.keyboard.press(" ");
      assert.equal(await page.locator("#play").getAttribute("aria-pressed"), "false");
      await page.locator("#curve").focus();
      const whole = await pixels(page, "#curve canvas");
      await page.keyboard.press("+");
      const part = await pixels(page, "#curve canvas");
      differ(part, whole);
      await page.keyboard.press("ArrowRight");
      assert.match(await page.locator("#curve .u-legend").innerText(), /strain \[–\]\s*[0-9.]+/);
      await page.keyboard.press("0");
      await close();
    });

    test("everything can be reached with the tabulator", async () => {
      const { page, close } = await open("fit", width);
      const reached = new Set();
      for (let i = 0; i < 60; i++) {
        await page.keyboard.press("Tab");
        reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.textContent));
      }
      for (const name of ["theme", "shear", "curve", "sequence", "answer", "shapes", "colour", "view", "play", "frame", "convergence"]) {
        assert.ok(reached.has(name), `${name} is not among ${[...reached].join(", ")}`);
      }
      await close();
    });

    test("shapes side by side, one alone, and other colours look different", async () => {
      const { page, close } = await open("fit", width);
      const seen = [await pixels(page, "#view")];
      for (const [id, value] of [["shapes", "beside"], ["shapes", "simulated"], ["shapes", "measured"], ["colour", "strain"], ["colour", "plain"]]) {
        await page.locator(`#${id}`).selectOption(value);
        seen.push(await pixels(page, "#view"));
        differ(seen.at(-1), seen.at(-2));
      }
      await close();
    });

    test("models are switched and compared", async () => {
      const { page, close } = await open("models", width);
      const before = await page.locator("#residuals").innerText();
      const curve = await pixels(page, "#curve canvas");
      await page.locator("#models button", { hasText: "springs" }).click();
      assert.equal(await page.locator("#models button", { hasText: "springs" }).getAttribute("aria-pressed"), "true");
      assert.notEqual(await page.locator("#residuals").innerText(), before);
      await page.locator("#beside button", { hasText: "stvk" }).click();
      differ(await pixels(page, "#curve canvas"), curve);
      await close();
    });

    test("a comparison shows all models and variants on one plot", async () => {
      const { page, close } = await open("compared", width);
      assert.equal(await page.locator("#ranking tr").count(), 13);
      assert.equal(await page.locator("#beside button").count(), 12);
      // Each click makes one of them pressed.
      const waiting = page.locator('#beside button[aria-pressed="false"]');
      for (let left = await waiting.count(); left > 0; left--) await waiting.first().click();
      await page.locator("#components button", { hasText: "shear" }).click();
      const labels = await page.locator("#curve .u-series:not(.quiet) .u-label").allTextContents();
      // A curve that is not observed has no line: springs may fail to see shear.
      const ranked = JSON.parse(readFileSync(join(out, "compared", "compare.json"), "utf8")).rows;
      const seen = ranked.filter((row) => !(row.missing ?? []).includes("shear")).length;
      assert.ok(seen >= 11, `${seen} of 12 see shear`);
      assert.equal(labels.length, 1 + seen);
      await page.locator("#sequence").selectOption("complex-shear");
      assert.ok((await pixels(page, "#answer canvas")).drawn > 1000);
      // Two cycles, each there and back, of 12 models and variants and of the measurement; the first of each is named.
      await page.locator("#sequence").selectOption("corner-pull");
      assert.ok((await pixels(page, "#answer canvas")).drawn > 1000);
      assert.equal(await page.locator("#answer .u-series").count(), 1 + 4 * 13);
      assert.equal(await page.locator("#answer .u-series:not(.quiet)").count(), 1 + 12 + 2);
      assert.equal(await page.locator("#frames-section").isVisible(), false);
      const [scroll, client] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
      assert.ok(scroll <= client, `${scroll} > ${client}`);
      await close();
    });
  });
}

test("dark follows the system, and the button", async () => {
  const { page, close } = await open("fit", 1280, "dark");
  const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  assert.equal(await paper(), "rgb(20, 24, 30)");
  await page.locator("#theme").click();
  assert.equal(await paper(), "rgb(255, 255, 255)");
  await close();
});

test("it prints in light colours, without buttons", async () => {
  const { page, close } = await open("fit", 1280, "dark");
  await page.emulateMedia({ media: "print" });
  assert.equal(await page.locator("#play").isVisible(), false);
  const sheets = await page.pdf({ format: "A4" });
  assert.ok(sheets.length > 50_000);
  await close();
});

test("tables show the numbers of residuals.csv", async () => {
  const { page, close } = await open("fit", 1280);
  const table = await page.locator("#residuals tr").evaluateAll((lines) => lines.slice(1).map((line) => [...line.cells].map((cell) => cell.textContent)));
  const expected = rows(join(out, "fit", "residuals.csv"));
  assert.equal(table.length, expected.length);
  const near = (shown, number) => assert.ok(number === "" ? shown === "–" : Math.abs(shown / number - 1) < 5.1e-4, `${shown} ${number}`);
  expected.forEach((row, i) => {
    const [name, frames, left, , force, , position] = table[i];
    assert.deepEqual([name, frames, left], [row.sequence, row.frames, row.frames_left_out]);
    near(force, row.rms_force_n);
    near(position, row.rms_position_m === "" ? "" : 1e3 * row.rms_position_m);
  });
  await close();
});

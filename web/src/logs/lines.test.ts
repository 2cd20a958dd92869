import { expect, test } from "vitest";

import type { LogLine } from "../api/types";
import { asText, chosen, missing, processesOf, timeOf } from "./lines";

const line = (number: number, level: LogLine["level"], process: string, text: string, times = 1): LogLine => ({ number, at: 1_700_000_000 + number, level, process, text, times });
const LINES = [line(1, "info", "web", "ready"), line(2, "warning", "supervisor", "perceive ended: it is started again"), line(3, "error", "perceive", "ValueError: x", 3)];
const ALL = { level: "info", process: "", words: "" } as const;
const numbers = (lines: LogLine[]) => lines.map((each) => each.number);

test("a level brings the worse ones with it", () => {
  expect(numbers(chosen(LINES, ALL))).toEqual([1, 2, 3]);
  expect(numbers(chosen(LINES, { ...ALL, level: "warning" }))).toEqual([2, 3]);
  expect(numbers(chosen(LINES, { ...ALL, level: "error" }))).toEqual([3]);
});

test("a line has to be of the process and to contain every word", () => {
  expect(numbers(chosen(LINES, { ...ALL, process: "web" }))).toEqual([1]);
  expect(numbers(chosen(LINES, { ...ALL, words: " started PERCEIVE" }))).toEqual([2]);
  expect(numbers(chosen(LINES, { ...ALL, words: "perceive" }))).toEqual([2, 3]);
  expect(processesOf(LINES)).toEqual(["perceive", "supervisor", "web"]);
});

test("a time has its date only on another day", () => {
  const at = new Date(2026, 10, 29, 7, 5, 9);
  expect(timeOf(at.getTime() / 1000, new Date(2026, 10, 29, 23))).toBe("07:05:09");
  expect(timeOf(at.getTime() / 1000, new Date(2026, 10, 30))).toBe("2026-11-29 07:05:09");
});

test("what is missing is told, and nothing else", () => {
  expect(missing({ left_out: 0, older: 0 })).toBe("");
  expect(missing({ left_out: 1, older: 12 })).toBe("1 line was left out because a process printed too many at once; 12 lines were dropped to make room for newer ones");
});

test("a copy tells date, level, process and how often", () => {
  expect(asText(LINES.slice(2))).toBe("2023-11-14T22:13:23.000Z error perceive: ValueError: x (3 times)\n");
});

// Requests to the service. A request that is refused raises an ApiError, which says what was asked, found and accepted.

import type { Problem } from "./types";

export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly problem: Problem,
  ) {
    super(problem.detail);
  }

  /** The field of the form that is wrong; empty: none in particular. */
  get field(): string {
    return this.problem.field ?? "";
  }
}

type Method = "GET" | "POST" | "PUT" | "PATCH" | "DELETE";

function request<T>(method: Method, path: string, body?: unknown): Promise<T> {
  return send<T>(method, path, body === undefined ? {} : { headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
}

async function send<T>(method: Method, path: string, content: Pick<RequestInit, "headers" | "body">): Promise<T> {
  let answer: Response;
  try {
    answer = await fetch(path, { method, credentials: "same-origin", ...content });
  } catch {
    throw new ApiError(0, problemOf(0, "The service does not answer. Nothing was changed; try again when it is back."));
  }
  const text = await answer.text();
  if (answer.ok) return (text ? JSON.parse(text) : undefined) as T;
  throw new ApiError(answer.status, parsed(text) ?? problemOf(answer.status, `The service answered ${answer.status}.`));
}

function parsed(text: string): Problem | null {
  try {
    const problem = JSON.parse(text) as Partial<Problem>;
    return typeof problem.detail === "string" ? (problem as Problem) : null;
  } catch {
    return null;
  }
}

function problemOf(status: number, detail: string): Problem {
  return { type: "about:blank", title: "", status, detail, instance: "" };
}

export const api = {
  get: <T>(path: string) => request<T>("GET", `/api/v1${path}`),
  post: <T>(path: string, body: unknown = {}) => request<T>("POST", `/api/v1${path}`, body),
  put: <T>(path: string, body: unknown) => request<T>("PUT", `/api/v1${path}`, body),
  patch: <T>(path: string, body: unknown) => request<T>("PATCH", `/api/v1${path}`, body),
  delete: <T>(path: string) => request<T>("DELETE", `/api/v1${path}`),
  file: <T>(path: string, file: Blob) => send<T>("POST", `/api/v1${path}`, { headers: { "Content-Type": "application/octet-stream" }, body: file }),
};

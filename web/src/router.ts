import { createRouter, createWebHistory, type Router } from "vue-router";

import MatchPage from "./pages/MatchPage.vue";

/** The router; it begins with the address at this moment. */
export function makeRouter(): Router {
  const router = createRouter({
  history: createWebHistory(),
  routes: [
    { path: "/", name: "match", component: MatchPage, meta: { title: "Match" } },
    { path: "/teams", name: "teams", component: () => import("./pages/TeamsPage.vue"), meta: { title: "Teams" } },
    { path: "/robots", name: "robots", component: () => import("./pages/RobotsPage.vue"), meta: { title: "Robots' views" } },
    { path: "/robot/:team(blue|yellow)/:number(\\d+)", name: "robot", component: () => import("./pages/RobotPage.vue"), meta: { title: "Robot's view" } },
    { path: "/robot", name: "team", component: () => import("./pages/TeamPage.vue"), meta: { title: "Your robots" } },
    { path: "/camera", name: "camera", component: () => import("./pages/CameraPage.vue"), meta: { title: "Camera" } },
    { path: "/calibrate", name: "calibrate", component: () => import("./pages/CalibratePage.vue"), meta: { title: "Calibrate the camera" } },
    { path: "/mirror", name: "mirror", component: () => import("./pages/MirrorPage.vue"), meta: { title: "Mirror" } },
    { path: "/venue", name: "venue", component: () => import("./pages/VenuePage.vue"), meta: { title: "Set up a venue" } },
    { path: "/3d", name: "3d", component: () => import("./pages/SpacePage.vue"), meta: { title: "3D" } },
    { path: "/settings", name: "settings", component: () => import("./pages/SettingsPage.vue"), meta: { title: "Settings" } },
    { path: "/timing", name: "timing", component: () => import("./pages/TimingPage.vue"), meta: { title: "Timing" } },
    { path: "/fairness", name: "fairness", component: () => import("./pages/FairnessPage.vue"), meta: { title: "Fairness" } },
    { path: "/logs", name: "logs", component: () => import("./pages/LogsPage.vue"), meta: { title: "Logs" } },
    { path: "/about", name: "about", component: () => import("./pages/AboutPage.vue"), meta: { title: "About" } },
    { path: "/login", name: "login", component: () => import("./pages/LoginPage.vue"), meta: { title: "Log in" } },
    { path: "/:path(.*)*", name: "lost", component: () => import("./pages/LostPage.vue"), meta: { title: "No such page" } },
  ],
});

  router.afterEach((to) => {
    document.title = `${String(to.meta.title)} · PSLV`;
    document.getElementById("content")?.focus({ preventScroll: true });
  });
  return router;
}

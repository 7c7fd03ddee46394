import { mount } from "svelte";
import { parseDeepLink, takeToken } from "../domain/screen/deep-link";
import { signIn } from "../sources/api";
import "../ui/base.css";
import App from "./App.svelte";
import { Address } from "./address";
import { Screen } from "./screen.svelte";

const target = document.getElementById("app");
if (target === null) throw new Error("index.html has no #app");

const { token, rest } = takeToken(window.location.hash);
if (token !== null) {
  history.replaceState(null, "", `${window.location.pathname}${window.location.search}${rest}`);
  await signIn(token).catch(() => undefined); // a wrong token leads to the sign-in, like none
}

// Read before anything writes the address.
const screen = new Screen(parseDeepLink(window.location.hash));
const address = new Address(window);
window.addEventListener("popstate", (event) => screen.travel(address.read(event.state)));
mount(App, { target, props: { screen, address } });
void screen.door.begin();

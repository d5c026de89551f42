(* LuGre's condition is necessary, for any storage function: at a constant level, and for the extremes of a level that varies. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion Power Terms Continuous Relaxation Passive Level Extract.
Open Scope R_scope.

Definition lugre_condition (p : constants) : Prop := sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p.

Section Necessary.
Variables (ok : constants -> Prop) (dz : constants -> R -> R -> R) (m : constants -> R -> R) (m0 : constants -> R).
Variables (share : constants -> R -> R -> R) (friction : constants -> R -> R -> R).
Hypothesis law : relaxation ok dz m m0 share.
Hypothesis friction_is : forall p v z, friction p v z = sigma_0 p * z + sigma_1 p * dz p v z + sigma_2 p * v.

(* The bristles wound up to top/sigma_0, then a fast pulse at the level of q. *)
Lemma wound_up_drained q top : ok q -> 0 < v_s q -> F_c q <= top ->
  sigma_2 q * F_c q < sigma_1 q * (top - F_c q) ->
  exists z1, 0 < z1 < top / sigma_0 q /\ drained (dz q) (friction q) z1 (top / sigma_0 q).
Proof.
  intros Hq Hv Ht Hw. destruct (r_constants _ _ _ _ _ law q Hq) as (H0 & H1 & H2 & Hc & HF).
  assert (P : 0 < sigma_1 q) by (destruct H1 as [L | L]; [exact L|rewrite <- L in Hw; nra]).
  set (d := sigma_1 q * (top - F_c q) - sigma_2 q * F_c q). assert (Hd : 0 < d) by (unfold d; lra).
  set (y := d / (2 * sigma_1 q)). assert (Y : 0 < y) by (apply Rdiv_lt_0_compat; lra).
  assert (Y1 : sigma_1 q * y = d / 2) by (unfold y; field; lra).
  assert (Y2 : y <= (top - F_c q) / 2).
  { apply Rmult_le_reg_l with (sigma_1 q); [exact P|]. rewrite Y1. unfold d. assert (0 <= sigma_2 q * F_c q) by nra. lra. }
  set (i := / sigma_0 q). assert (I : 0 < i) by (apply Rinv_0_lt_compat; exact H0).
  assert (Z : 0 < (top - y) * i < top * i) by (split; [apply Rmult_lt_0_compat; lra|apply Rmult_lt_compat_r; lra]).
  exists ((top - y) * i). split; [exact Z|].
  apply (fast_pulse q (dz q) (friction q) (m q) (m0 q)); auto; try lra.
  - intros v Vp. pose proof (r_majorant _ _ _ _ _ law q v Hq) as B. rewrite Rabs_pos_eq in B by lra. exact B.
  - intros v z Vp Zp Hz. rewrite (r_rate _ _ _ _ _ law) by exact Hq.
    destruct (r_beyond _ _ _ _ _ law q v z Hq) as [-> | [N _]]; [rewrite Rabs_pos_eq; lra|rewrite Rmult_1_l; reflexivity|].
    assert (0 < v * z) by (apply Rmult_lt_0_compat; assumption). lra.
  - replace (sigma_0 q * ((top - y) * i)) with (top - y) by (unfold i; field; lra).
    replace (sigma_1 q * (top - y - F_c q)) with (sigma_1 q * (top - F_c q) - sigma_1 q * y) by ring.
    rewrite Y1. unfold d. unfold d in Hd. lra.
Qed.

Lemma within_between (z1 Z : R) : 0 < z1 -> forall z, z1 <= z <= Z -> within Z z.
Proof. intros H z Hz. unfold within. rewrite Rabs_pos_eq; lra. Qed.

Theorem law_necessary p : ok p -> 0 < v_s p -> passive (dz p) (friction p) (within (F_s p / sigma_0 p)) -> lugre_condition p.
Proof.
  intros Hp Hv HP. destruct (Rle_lt_dec (sigma_1 p * (F_s p - F_c p)) (sigma_2 p * F_c p)) as [L | L]; [exact L|exfalso].
  destruct (r_constants _ _ _ _ _ law p Hp) as (_ & _ & _ & _ & HF).
  destruct (wound_up_drained p (F_s p) Hp Hv HF L) as (z1 & Hz & D).
  apply (not_passive (dz p) (friction p) (within (F_s p / sigma_0 p)) z1 (F_s p / sigma_0 p)); auto; [lra|].
  apply within_between. lra.
Qed.

(* Wound up at the highest level, the level dropped to the lowest: what is needed is the condition with the two extremes. *)
Theorem varying_necessary p : ok p -> 0 < v_s p ->
  (exists S, storage (varying dz p) (within_levels p) (varying_power friction p) (within (F_s p / sigma_0 p)) S) ->
  lugre_condition p.
Proof.
  intros Hp Hv HP. destruct (Rle_lt_dec (sigma_1 p * (F_s p - F_c p)) (sigma_2 p * F_c p)) as [L | L]; [exact L|exfalso].
  destruct (r_constants _ _ _ _ _ law p Hp) as (_ & _ & _ & _ & HF).
  set (q := at_level p (F_c p) (F_c p)).
  assert (Hq : ok q) by (apply (r_level _ _ _ _ _ law); [exact Hp|lra]).
  destruct (wound_up_drained q (F_s p) Hq Hv HF L) as (z1 & Hz & D). simpl in Hz.
  revert HP. apply (no_storage (U := Levels) _ _ _ (fun v => (v, (F_c p, F_c p))) (dz q) (friction q) _ z1 (F_s p / sigma_0 p));
    auto; [lra|apply within_between; lra|].
  intros v. unfold within_levels, level_c, level_s; simpl. lra.
Qed.
End Necessary.

Theorem lugre_necessary p : lugre.allowed p ->
  passive (lugre.dz_dt p) (lugre.friction p) (within (lugre.z_bound p)) -> lugre_condition p.
Proof. intros H. apply (law_necessary _ _ _ _ _ lugre.friction lugre_form); auto. known H. lra. Qed.
Theorem lugre_level_necessary p : lugre.allowed p ->
  (exists S, storage (varying lugre.dz_dt p) (within_levels p) (varying_power lugre.friction p) (within (lugre.z_bound p)) S) ->
  lugre_condition p.
Proof. intros H. apply (varying_necessary _ _ _ _ _ lugre.friction lugre_form); auto. known H. lra. Qed.
Theorem lugre_passive_iff p : lugre.allowed p ->
  (passive (lugre.dz_dt p) (lugre.friction p) (within (lugre.z_bound p)) <-> lugre_condition p).
Proof.
  intros H. split; [apply lugre_necessary; exact H|]. intros L.
  exists (lugre.stored_energy p). apply lugre_passive; [exact H|]. exact L.
Qed.

Theorem elastoplastic_necessary p : elastoplastic.allowed p ->
  passive (elastoplastic.dz_dt p) (elastoplastic.friction p) (within (elastoplastic.z_bound p)) -> lugre_condition p.
Proof. intros H. apply (law_necessary _ _ _ _ _ elastoplastic.friction elastoplastic_form); auto. known H. lra. Qed.
Theorem elastoplastic_level_necessary p : elastoplastic.allowed p ->
  (exists S, storage (varying elastoplastic.dz_dt p) (within_levels p) (varying_power elastoplastic.friction p) (within (elastoplastic.z_bound p)) S) ->
  lugre_condition p.
Proof. intros H. apply (varying_necessary _ _ _ _ _ elastoplastic.friction elastoplastic_form); auto. known H. lra. Qed.
Theorem elastoplastic_passive_iff p : elastoplastic.allowed p ->
  (passive (elastoplastic.dz_dt p) (elastoplastic.friction p) (within (elastoplastic.z_bound p)) <-> lugre_condition p).
Proof.
  intros H. split; [apply elastoplastic_necessary; exact H|]. intros L.
  exists (elastoplastic.stored_energy p). apply elastoplastic_passive; [exact H|]. exact L.
Qed.

Theorem lugre_majorant_necessary p : lugre_majorant.allowed p ->
  passive (lugre_majorant.dz_dt p) (lugre_majorant.friction p) (within (lugre_majorant.z_bound p)) -> lugre_condition p.
Proof. intros H. apply (law_necessary _ _ _ _ _ lugre_majorant.friction lugre_majorant_form); auto. known H. lra. Qed.
Theorem lugre_majorant_level_necessary p : lugre_majorant.allowed p ->
  (exists S, storage (varying lugre_majorant.dz_dt p) (within_levels p) (varying_power lugre_majorant.friction p) (within (lugre_majorant.z_bound p)) S) ->
  lugre_condition p.
Proof. intros H. apply (varying_necessary _ _ _ _ _ lugre_majorant.friction lugre_majorant_form); auto. known H. lra. Qed.
Theorem lugre_majorant_passive_iff p : lugre_majorant.allowed p -> sigma_1 p * excess_atan p <= F_s p ->
  (passive (lugre_majorant.dz_dt p) (lugre_majorant.friction p) (within (lugre_majorant.z_bound p)) <-> lugre_condition p).
Proof.
  intros H Hm. split; [apply lugre_majorant_necessary; exact H|]. intros L.
  exists (lugre_majorant.stored_energy p). apply lugre_majorant_passive; [exact H|]. split; [exact L|exact Hm].
Qed.

Theorem lugre_majorant_sqrt_necessary p : lugre_majorant_sqrt.allowed p ->
  passive (lugre_majorant_sqrt.dz_dt p) (lugre_majorant_sqrt.friction p) (within (lugre_majorant_sqrt.z_bound p)) -> lugre_condition p.
Proof. intros H. apply (law_necessary _ _ _ _ _ lugre_majorant_sqrt.friction lugre_majorant_sqrt_form); auto. known H. lra. Qed.
Theorem lugre_majorant_sqrt_level_necessary p : lugre_majorant_sqrt.allowed p ->
  (exists S, storage (varying lugre_majorant_sqrt.dz_dt p) (within_levels p) (varying_power lugre_majorant_sqrt.friction p) (within (lugre_majorant_sqrt.z_bound p)) S) ->
  lugre_condition p.
Proof. intros H. apply (varying_necessary _ _ _ _ _ lugre_majorant_sqrt.friction lugre_majorant_sqrt_form); auto. known H. lra. Qed.
Theorem lugre_majorant_sqrt_passive_iff p : lugre_majorant_sqrt.allowed p -> sigma_1 p * excess_sqrt p <= F_s p ->
  (passive (lugre_majorant_sqrt.dz_dt p) (lugre_majorant_sqrt.friction p) (within (lugre_majorant_sqrt.z_bound p)) <-> lugre_condition p).
Proof.
  intros H Hm. split; [apply lugre_majorant_sqrt_necessary; exact H|]. intros L.
  exists (lugre_majorant_sqrt.stored_energy p). apply lugre_majorant_sqrt_passive; [exact H|]. split; [exact L|exact Hm].
Qed.

Theorem lugre_majorant_compact_necessary p : lugre_majorant_compact.allowed p ->
  passive (lugre_majorant_compact.dz_dt p) (lugre_majorant_compact.friction p) (within (lugre_majorant_compact.z_bound p)) -> lugre_condition p.
Proof. intros H. apply (law_necessary _ _ _ _ _ lugre_majorant_compact.friction lugre_majorant_compact_form); auto. known H. lra. Qed.
Theorem lugre_majorant_compact_level_necessary p : lugre_majorant_compact.allowed p ->
  (exists S, storage (varying lugre_majorant_compact.dz_dt p) (within_levels p) (varying_power lugre_majorant_compact.friction p) (within (lugre_majorant_compact.z_bound p)) S) ->
  lugre_condition p.
Proof. intros H. apply (varying_necessary _ _ _ _ _ lugre_majorant_compact.friction lugre_majorant_compact_form); auto. known H. lra. Qed.
Theorem lugre_majorant_compact_passive_iff p : lugre_majorant_compact.allowed p -> sigma_1 p * excess_compact p <= F_s p ->
  (passive (lugre_majorant_compact.dz_dt p) (lugre_majorant_compact.friction p) (within (lugre_majorant_compact.z_bound p)) <-> lugre_condition p).
Proof.
  intros H Hm. split; [apply lugre_majorant_compact_necessary; exact H|]. intros L.
  exists (lugre_majorant_compact.stored_energy p). apply lugre_majorant_compact_passive; [exact H|]. split; [exact L|exact Hm].
Qed.

Theorem elastoplastic_majorant_necessary p : elastoplastic_majorant.allowed p ->
  passive (elastoplastic_majorant.dz_dt p) (elastoplastic_majorant.friction p) (within (elastoplastic_majorant.z_bound p)) -> lugre_condition p.
Proof. intros H. apply (law_necessary _ _ _ _ _ elastoplastic_majorant.friction elastoplastic_majorant_form); auto. known H. lra. Qed.
Theorem elastoplastic_majorant_level_necessary p : elastoplastic_majorant.allowed p ->
  (exists S, storage (varying elastoplastic_majorant.dz_dt p) (within_levels p) (varying_power elastoplastic_majorant.friction p) (within (elastoplastic_majorant.z_bound p)) S) ->
  lugre_condition p.
Proof. intros H. apply (varying_necessary _ _ _ _ _ elastoplastic_majorant.friction elastoplastic_majorant_form); auto. known H. lra. Qed.
Theorem elastoplastic_majorant_passive_iff p : elastoplastic_majorant.allowed p -> sigma_1 p * excess_atan p <= F_s p ->
  (passive (elastoplastic_majorant.dz_dt p) (elastoplastic_majorant.friction p) (within (elastoplastic_majorant.z_bound p)) <-> lugre_condition p).
Proof.
  intros H Hm. split; [apply elastoplastic_majorant_necessary; exact H|]. intros L.
  exists (elastoplastic_majorant.stored_energy p). apply elastoplastic_majorant_passive; [exact H|]. split; [exact L|exact Hm].
Qed.

Theorem elastoplastic_majorant_sqrt_necessary p : elastoplastic_majorant_sqrt.allowed p ->
  passive (elastoplastic_majorant_sqrt.dz_dt p) (elastoplastic_majorant_sqrt.friction p) (within (elastoplastic_majorant_sqrt.z_bound p)) -> lugre_condition p.
Proof. intros H. apply (law_necessary _ _ _ _ _ elastoplastic_majorant_sqrt.friction elastoplastic_majorant_sqrt_form); auto. known H. lra. Qed.
Theorem elastoplastic_majorant_sqrt_level_necessary p : elastoplastic_majorant_sqrt.allowed p ->
  (exists S, storage (varying elastoplastic_majorant_sqrt.dz_dt p) (within_levels p) (varying_power elastoplastic_majorant_sqrt.friction p) (within (elastoplastic_majorant_sqrt.z_bound p)) S) ->
  lugre_condition p.
Proof. intros H. apply (varying_necessary _ _ _ _ _ elastoplastic_majorant_sqrt.friction elastoplastic_majorant_sqrt_form); auto. known H. lra. Qed.
Theorem elastoplastic_majorant_sqrt_passive_iff p : elastoplastic_majorant_sqrt.allowed p -> sigma_1 p * excess_sqrt p <= F_s p ->
  (passive (elastoplastic_majorant_sqrt.dz_dt p) (elastoplastic_majorant_sqrt.friction p) (within (elastoplastic_majorant_sqrt.z_bound p)) <-> lugre_condition p).
Proof.
  intros H Hm. split; [apply elastoplastic_majorant_sqrt_necessary; exact H|]. intros L.
  exists (elastoplastic_majorant_sqrt.stored_energy p). apply elastoplastic_majorant_sqrt_passive; [exact H|]. split; [exact L|exact Hm].
Qed.

Theorem elastoplastic_majorant_compact_necessary p : elastoplastic_majorant_compact.allowed p ->
  passive (elastoplastic_majorant_compact.dz_dt p) (elastoplastic_majorant_compact.friction p) (within (elastoplastic_majorant_compact.z_bound p)) -> lugre_condition p.
Proof. intros H. apply (law_necessary _ _ _ _ _ elastoplastic_majorant_compact.friction elastoplastic_majorant_compact_form); auto. known H. lra. Qed.
Theorem elastoplastic_majorant_compact_level_necessary p : elastoplastic_majorant_compact.allowed p ->
  (exists S, storage (varying elastoplastic_majorant_compact.dz_dt p) (within_levels p) (varying_power elastoplastic_majorant_compact.friction p) (within (elastoplastic_majorant_compact.z_bound p)) S) ->
  lugre_condition p.
Proof. intros H. apply (varying_necessary _ _ _ _ _ elastoplastic_majorant_compact.friction elastoplastic_majorant_compact_form); auto. known H. lra. Qed.
Theorem elastoplastic_majorant_compact_passive_iff p : elastoplastic_majorant_compact.allowed p -> sigma_1 p * excess_compact p <= F_s p ->
  (passive (elastoplastic_majorant_compact.dz_dt p) (elastoplastic_majorant_compact.friction p) (within (elastoplastic_majorant_compact.z_bound p)) <-> lugre_condition p).
Proof.
  intros H Hm. split; [apply elastoplastic_majorant_compact_necessary; exact H|]. intros L.
  exists (elastoplastic_majorant_compact.stored_energy p). apply elastoplastic_majorant_compact_passive; [exact H|]. split; [exact L|exact Hm].
Qed.

